"""The floor at the operators' desk: read, looked at, and changed in its file, which the programs of the master read."""

import json
import stat
from pathlib import Path
from typing import Any

import pytest

from laser_bot_battle.floor import MAX_BYTES, Zone, read_floor
from server.web.floor_file import Description, FloorFile, OtherVersionError, to_text
from tests.support.programs import ROOT
from tests.unit.server.test_operator_api import BEARER, Site, done, refused

HILL = {"name": "the hill", "kind": "hill", "x": 2, "y": 1, "radius": 0.3}
FLOOR: dict[str, Any] = {
    "width": 4,
    "height": 2,
    "walls": [[1, 0, 1, 1]],
    "starts": [[0.5, 1], [3, 1, 1.5]],
    "zones": [HILL],
}


class Hall:
    """A server whose floor is described by a file."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / "hall.json"
        self.file.write_text(json.dumps(FLOOR))
        self.site = Site(folder, LASERBOT_FLOOR=str(self.file))
        self.browser = self.site.operator("Ann")

    def get(self) -> dict[str, Any]:
        known: dict[str, Any] = self.browser.get("/operator/api/floor").json
        return known

    def put(self, version: str | None = None, **changes: Any) -> Any:
        wanted = {"floor": {**FLOOR, **changes}, "version": self.get()["version"] if version is None else version}
        return self.browser.put("/operator/api/floor", json=wanted)

    def check(self, **changes: Any) -> dict[str, Any]:
        found: dict[str, Any] = self.browser.post(
            "/operator/api/floor/check", json={"floor": {**FLOOR, **changes}}
        ).json
        return found


@pytest.fixture
def hall(tmp_path: Path) -> Any:
    hall = Hall(tmp_path)
    yield hall
    hall.site.database.close()


def test_a_changed_floor_is_in_its_file_and_in_use_and_the_log_says_who_did_it(hall: Hall) -> None:
    known = hall.get()
    assert (known["floor"], known["path"], known["name"], known["is_writable"]) == (FLOOR, str(hall.file), "", True)
    answer = hall.put(zones=[{**HILL, "x": 3}])
    assert answer.status_code == 200
    assert hall.get()["version"] == answer.json["version"] != known["version"]
    assert read_floor(str(hall.file)).zones == (Zone("the hill", "hill", 3, 1, 0.3),)
    done(hall.browser.put("/operator/api/rules", json={"hill": True}))
    assert [(place.kind, place.x) for place in hall.site.game.snapshot().places] == [("hill", 3)]
    assert "FloorChanged" in hall.site.keep()
    assert any("floor was changed" in one["text"] and "Ann" in one["text"] for one in hall.site.log.latest())


def test_everything_that_is_wrong_is_told_beside_what_it_is_about(hall: Hall) -> None:
    assert hall.check()["problems"] == []
    wrong: dict[str, Any] = {
        "walls": [[1, 0, 1, 1], [2, 1, 2, 1]],
        "starts": [[0.5, 1], [0.01, 1], [3, 1], [3, 9]],
        "zones": [HILL, HILL],
    }
    problems = [(one["about"], one["error"].split(":")[0]) for one in hall.check(**wrong)["problems"]]
    assert problems == [
        ("walls[1]", "must be at least 0.01 m long"),
        ("starts[3]", "y"),
        ("starts[1]", "a robot does not fit"),
        ("zones[1]", "name"),
    ]
    assert refused(hall.put(**wrong), 400) == "walls[1]: must be at least 0.01 m long"
    assert hall.get()["floor"] == FLOOR


@pytest.mark.parametrize(
    "wrong", [{"width": None}, {"walls": {}}, {"starts": "here"}, {"zones": [1]}, {"colour": "red"}]
)
def test_what_is_no_floor_at_all_is_told_too(hall: Hall, wrong: dict[str, Any]) -> None:
    assert hall.check(**wrong)["problems"]
    assert refused(hall.put(**wrong), 400)
    assert refused(hall.put(walls=[[0, 0, 1, 1]] * (MAX_BYTES // 10)), 400, 413)
    assert refused(hall.browser.put("/operator/api/floor", json={"floor": FLOOR}), 400)
    assert hall.get()["floor"] == FLOOR


def test_the_tags_of_a_floor_of_that_size_are_shown(hall: Hall) -> None:
    tags = {tag["number"]: (tag["x"], tag["y"]) for tag in hall.check(width=3.6)["tags"]}
    assert tags[200] == (-0.15, -0.15)
    assert (3.75, 2.15) in tags.values()


def test_two_operators_do_not_undo_each_other(hall: Hall) -> None:
    version = hall.get()["version"]
    assert hall.put(version, width=3.5).status_code == 200
    assert "somebody else" in refused(hall.put(version, width=3.6), 409)
    assert hall.get()["floor"]["width"] == 3.5


def test_the_floor_stays_while_a_countdown_or_battle_runs(hall: Hall) -> None:
    hall.site.players("ada", "bob", ready=True)
    assert "battle" in refused(hall.put(width=3.6), 409)
    hall.site.pass_time(15)
    assert "battle" in refused(hall.put(width=3.6), 409)
    assert hall.get()["floor"] == FLOOR
    assert [path.name for path in hall.file.parent.glob(".hall*")] == []
    assert "FloorChanged" not in hall.site.keep()


def test_a_floor_that_comes_along_stays_as_it_is(tmp_path: Path) -> None:
    site = Site(tmp_path, LASERBOT_FLOOR="Battle")
    known = site.browser().get("/operator/api/floor", headers=BEARER).json
    assert (known["name"], known["is_writable"]) == ("battle", False)
    wanted = {"floor": known["floor"], "version": known["version"]}
    assert "battle" in refused(site.browser().put("/operator/api/floor", json=wanted, headers=BEARER), 409)
    site.database.close()


def test_only_operators_see_and_change_it(hall: Hall) -> None:
    stranger = hall.site.browser()
    assert refused(stranger.get("/operator/api/floor"), 401)
    assert refused(stranger.post("/operator/api/floor/check", json={"floor": FLOOR}), 401)
    assert refused(stranger.put("/operator/api/floor", json={"floor": FLOOR, "version": hall.get()["version"]}), 401)


def test_a_file_that_is_no_floor_or_gone_is_told(hall: Hall) -> None:
    hall.file.write_text('{"width": 4}')
    assert "height: is missing" in refused(hall.browser.get("/operator/api/floor"), 503)
    hall.file.unlink()
    assert "No such file" in refused(hall.browser.get("/operator/api/floor"), 503)
    assert "not to be written" in refused(hall.put("any"), 409)


def test_a_file_is_replaced_as_a_whole_and_keeps_its_rights(tmp_path: Path) -> None:
    path, link = tmp_path / "hall.json", tmp_path / "floor.json"
    path.write_text(json.dumps(FLOOR))
    path.chmod(0o640)
    link.symlink_to(path)
    file = FloorFile(str(link))
    first = file.read().version

    def fail() -> None:
        raise OSError("no")

    with pytest.raises(OSError, match="no"):
        file.write({**FLOOR, "width": 3.5}, first, fail)
    with pytest.raises(OtherVersionError):
        file.write({**FLOOR, "width": 3.5}, "another", lambda: None)
    assert file.read() == Description(FLOOR, first)
    version = file.write({**FLOOR, "width": 3.5}, first, lambda: None)
    assert file.read() == Description({**FLOOR, "width": 3.5}, version)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert link.is_symlink()
    assert sorted(tmp_path.iterdir()) == [link, path]


def test_the_file_is_for_people_to_read() -> None:
    text = to_text(json.loads((ROOT / "floors/hall.json").read_text()))
    assert '  "width": 4.0,\n' in text
    assert '\n    {"name": "west", "kind": "pick-up", "x": 0.8, "y": 1.125, "radius": 0.1},\n' in text
    assert json.loads(text) == json.loads((ROOT / "floors/hall.json").read_text())
