"""The floor's file: what it says, and what is wrong with one."""

import json
from pathlib import Path
from typing import Any

import pytest

from laser_bot_battle.floor import MAX_BYTES, NAMES, Floor, Zone, parse_floor, read_floor
from laser_bot_battle.settings import SettingsError
from tests.support.documents import page
from tests.support.programs import ROOT

FLOOR: dict[str, Any] = {
    "width": 4,
    "height": 2.25,
    "walls": [[1, 0, 1, 1]],
    "starts": [[0.5, 1.125], [3, 1, 1.5]],
    "zones": [{"name": "the hill", "kind": "hill", "x": 2, "y": 1, "radius": 0.3}],
}
OUTER = ((0, 0, 4, 0), (4, 0, 4, 2.25), (4, 2.25, 0, 2.25), (0, 2.25, 0, 0))


def parsed(**changes: Any) -> Floor:
    return parse_floor(json.dumps({**FLOOR, **changes}).encode())


def test_a_file_describes_a_floor() -> None:
    assert parsed() == Floor(
        4,
        2.25,
        (*OUTER, (1, 0, 1, 1)),
        ((0.5, 1.125, 0.0), (3, 1, 1.5)),  # the first looks at the middle
        (Zone("the hill", "hill", 2, 1, 0.3),),
    )


def test_walls_and_zones_may_be_left_out() -> None:
    floor = parse_floor(b'{"width": 4, "height": 2.25, "starts": [[1, 1]]}')
    assert (floor.walls, floor.zones) == (OUTER, ())


@pytest.mark.parametrize("name", NAMES)
def test_our_own_floors_are_found_by_name(name: str) -> None:
    assert read_floor(name.upper()) == read_floor(name)
    assert len(read_floor(name).starts) == 8


def test_a_floor_is_read_from_a_path(tmp_path: Path) -> None:
    path = tmp_path / "hall.json"
    path.write_text(json.dumps(FLOOR))
    assert read_floor(str(path)) == parsed()
    path.write_text("{}")
    with pytest.raises(SettingsError, match=rf"^{path}: the file: width: is missing$"):
        read_floor(str(path))


def test_what_is_no_floor_is_told_by_its_name(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"^hall: there is no such floor; there are battle, duel, and files"):
        read_floor("hall")
    with pytest.raises(SettingsError, match=r"gone\.json: cannot be read: No such file"):
        read_floor(str(tmp_path / "gone.json"))
    with pytest.raises(SettingsError, match="cannot be read: Is a directory"):
        read_floor(f"{tmp_path}/")


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"width": 21}, "width: must be a number from 0.4 to 20"),
        ({"width": True}, "width: must be a number from 0.4 to 20"),
        ({"height": "2"}, "height: must be a number from 0.4 to 20"),
        ({"height": 10**400}, "height: must be a number from 0.4 to 20"),
        ({"wals": []}, "the file: wals: there is no such field; the nearest is walls"),
        ({"colour": "red"}, "the file: colour: there is no such field; there are width, height, walls, starts, zones"),
        ({"walls": {}}, "walls: must be a list of at most 200"),
        ({"walls": [[0, 0, 1, 1]] * 201}, "walls: must be a list of at most 200"),
        ({"walls": [[0, 0, 1]]}, "walls[0]: must be [x1, y1, x2, y2]"),
        ({"walls": [[0, 0, 1, 1], [0, 0, 4.1, 1]]}, "walls[1]: x: must be a number from 0 to 4"),
        ({"walls": [[1, 1, 1, 1.005]]}, "walls[0]: must be at least 0.01 m long"),
        ({"starts": []}, "starts: must have one place at least"),
        ({"starts": [[1, 1, 7]]}, "starts[0]: heading: must be a number from -6.28319 to 6.28319"),
        ({"starts": [[3, 1], [0.05, 1]]}, "starts[1]: a robot does not fit: it needs 0.075 m to each wall"),
        ({"starts": [[1.07, 0.5]]}, "starts[0]: a robot does not fit: it needs 0.075 m to each wall"),
        ({"starts": [[3, 1], [3.1, 1.1]]}, "starts[1]: two robots do not fit here and at starts[0]"),
        ({"zones": [{}]}, "zones[0]: name: is missing"),
        ({"zones": ["hill"]}, "zones[0]: must be an object with name, kind, x, y, radius"),
        ({"zones": [{**FLOOR["zones"][0], "kind": "swamp"}]}, "zones[0]: kind: must be one of hill, pick-up"),
        ({"zones": [{**FLOOR["zones"][0], "name": "<b>"}]}, "zones[0]: name: must be 1 to 40 letters"),
        ({"zones": [{**FLOOR["zones"][0], "radius": 0}]}, "zones[0]: radius: must be a number from 0.05 to 20"),
        ({"zones": FLOOR["zones"] * 2}, "zones[1]: name: another zone has 'the hill', too"),
    ],
)
def test_a_wrong_field_is_named(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError) as error:
        parsed(**changes)
    assert str(error.value).startswith(text)


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"", "line 1, column 1: is no JSON"),
        (b"{\n  'width': 4}", "line 2, column 3: is no JSON"),
        (b"[]", "the file: must be an object with width"),
        (b"[" * 50_000, "is nested too deeply"),
        (b"\xff\xfe\xff", "is no UTF-8 text"),
        (b'{"width": NaN}', "NaN is no number"),
        (b'{"width": 4, "width": 5}', "width: is there twice"),
        (b" " * (MAX_BYTES + 1), "is larger than 100000 bytes"),
    ],
)
def test_what_is_no_such_file_is_refused(data: bytes, text: str) -> None:
    with pytest.raises(ValueError) as error:
        parse_floor(data)
    assert str(error.value).startswith(text)


def test_the_example_is_a_floor_and_the_page_shows_it() -> None:
    example = (ROOT / "floors/hall.json").read_text()
    assert f"```json\n{example}```" in page("floor.md")
    assert {zone.kind for zone in read_floor(str(ROOT / "floors/hall.json")).zones} == {"hill", "pick-up"}
