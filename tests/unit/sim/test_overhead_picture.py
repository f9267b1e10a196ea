"""The picture of the camera above the floor."""

import argparse
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from laser_bot_battle.apriltag import Detection, Detector
from laser_bot_battle.floor import Floor
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.tags import floor_tags
from sim.arena.cameras.scene import Body, Scene
from sim.arena.overhead.conditions import Conditions, add_options
from sim.arena.overhead.lens import HEIGHT, WIDTH
from sim.arena.overhead.picture import FOOT_PERIOD, TAG_HEIGHT, Painter
from sim.arena.overhead.room import Room
from tests.support.floors import BATTLE_FLOOR

HALL = Floor.of(4, 2.25, ((2, 0.5, 2, 1.5),), ((1, 1),))
CORNER = Body("virtual3", 3, 0.3, 0.2, 0.5)
MIDDLE = Body("virtual12", 12, 0.9, 0.6, -2)


def painter(floor: Floor = BATTLE_FLOOR, **conditions: float) -> Painter:
    return Painter(Room.decode(Room(floor, Conditions(**conditions)).encode()))


def scene(*robots: Body, time: float = 0.0) -> Scene:
    return Scene("above", time, 0.0, robots)


def found(picture: NDArray[np.uint8]) -> dict[int, Detection]:
    return {one.number: one for one in Detector(2).detect(picture[0].tobytes(), WIDTH, HEIGHT)}


def middle(tag: Detection) -> NDArray[np.float64]:
    return np.mean(tag.corners, axis=0)


def size(tag: Detection) -> float:
    """Pixels of an edge, on average."""
    corners = np.array(tag.corners)
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).mean())


@pytest.mark.parametrize(
    ("floor", "conditions"),
    [(BATTLE_FLOOR, {}), (HALL, {"height": 3}), (BATTLE_FLOOR, {"height": 0.8, "lens": 0.3})],
    ids=["battle", "hall", "enlarged"],
)
def test_it_shows_each_tag_of_the_floor_and_of_robots(floor: Floor, conditions: dict[str, float]) -> None:
    tags = found(painter(floor, **conditions).picture(scene(CORNER, MIDDLE)))
    assert tags.keys() == {3, 12, *floor_tags(floor)}


def test_what_is_higher_seems_farther_from_the_middle() -> None:
    above = painter(tilt=10, lens=-0.2)
    lens, seen = above.lens, found(above.picture(scene(CORNER)))
    on_floor, on_top = lens.see(np.array([[0.3, 0.2, 0], [0.3, 0.2, TAG_HEIGHT]]))
    assert np.linalg.norm(on_floor - on_top) > 5
    assert middle(seen[3]) == pytest.approx(on_top, abs=0.7)


def test_each_pixel_shows_the_place_that_is_seen_there() -> None:
    lens = painter(tilt=15, lens=-0.3).lens
    rows, columns = np.array([20, 300, 700]), np.array([400, 640, 1100])
    for height in (0.0, 0.11):
        x, y = lens.at(height)
        places = np.column_stack([x[rows, columns], y[rows, columns], [height] * 3])
        assert lens.see(places) == pytest.approx(np.column_stack([columns, rows]) + 0.5, abs=0.01)


def test_a_robot_that_leaves_is_gone_from_the_picture() -> None:
    above = painter()
    empty = above.picture(scene())
    with_robot = above.picture(scene(MIDDLE))
    assert (with_robot != empty).any()
    assert (above.picture(scene()) == empty).all()


def test_what_moves_is_blurred_and_what_stands_is_not() -> None:
    moved = replace(MIDDLE, x=MIDDLE.x + 0.008)
    sharp, blurred = painter(), painter(exposure=0.06)
    blurred.picture(scene(CORNER, MIDDLE))
    before, after = sharp.picture(scene(CORNER, moved)), blurred.picture(scene(CORNER, moved, time=0.06))
    differs = np.argwhere((before != after).any(axis=0))
    tag = middle(found(before)[12])
    assert len(differs) > 100
    assert np.linalg.norm(differs[:, ::-1] - tag, axis=1).max() < 60
    assert middle(found(after)[12])[0] < tag[0]  # it was on its way


def test_a_foot_covers_one_quarter_after_the_other() -> None:
    above = painter(foot=0.2)
    quarters = ({200, 201}, {201, 202}, {204, 205}, {203, 204})  # floor tags, by the bottom left quarter and so on
    tags = set(floor_tags(BATTLE_FLOOR))
    assert found(above.picture(scene(time=0.3 * FOOT_PERIOD))).keys() == tags
    for number, covered in enumerate(quarters):
        seen = found(above.picture(scene(time=(number + 0.1) * FOOT_PERIOD))).keys()
        assert tags - seen == covered


def test_light_noise_and_print_are_as_they_are_set() -> None:
    plain = painter().picture(scene(MIDDLE))
    shady = painter(shade=0.5).picture(scene(MIDDLE))
    assert shady[0, -1, 0] == pytest.approx(plain[0, -1, 0] / 2, abs=1)
    assert shady[0, 0, -1] == plain[0, 0, -1]
    noisy = painter(noise=8).picture(scene(MIDDLE))
    assert np.std(noisy[0].astype(int) - plain[0]) == pytest.approx(8, rel=0.02)
    small = found(painter(print=0.95).picture(scene(MIDDLE)))
    for number, tag in found(plain).items():
        assert size(small[number]) / size(tag) == pytest.approx(0.95, abs=0.01)


def test_a_camera_that_hangs_too_low_for_its_lens_is_told() -> None:
    with pytest.raises(SettingsError, match="does not see the whole floor: hang it higher"):
        painter(HALL, height=1.5, lens=-0.3)


def test_options_say_the_conditions() -> None:
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_options(parser)
    conditions = Conditions(height=3, tilt=15, lens=-0.25, print=0.98)
    assert Conditions.of(parser.parse_args(conditions.options.split())) == conditions
    assert Conditions().options == ""
    for wrong in ("16", "-1", "nan", "x"):
        with pytest.raises(argparse.ArgumentError, match="is not a number from 0 to 15"):
            parser.parse_args([f"--overhead-tilt={wrong}"])
