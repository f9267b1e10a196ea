"""The tags: what they look like, where the floor's lie, and that the library finds them in a picture."""

import ctypes
import math
from typing import NamedTuple

import numpy as np
import pytest

from laser_bot_battle import apriltag
from laser_bot_battle.names import ROBOT_IDS
from laser_bot_battle.tags import FIRST_FLOOR_TAG, OUTSIDE, SPACING, floor_tags, tag_picture


class Size(NamedTuple):
    width: float
    height: float


def grey(number: int, cell: int = 8, margin: int = 20) -> np.ndarray:
    cells = np.kron(np.array(tag_picture(number), np.uint8) * 255, np.ones((cell, cell), np.uint8))
    return np.pad(cells, margin, constant_values=255)


def test_a_tag_has_a_white_border_around_a_black_one() -> None:
    cells = np.array(tag_picture(ROBOT_IDS[-1]))
    assert cells.shape == (10, 10)
    assert cells[[0, -1]].all() and cells[:, [0, -1]].all()
    assert not cells[[1, -2], 1:-1].any() and not cells[1:-1, [1, -2]].any()
    assert cells[2:-2, 2:-2].any()


def test_a_number_without_a_tag_is_refused() -> None:
    with pytest.raises(ValueError, match="there is no tag 587"):
        tag_picture(apriltag.TAGS)


@pytest.mark.parametrize("decimate", [1, 2])
def test_a_tag_is_found_with_its_corners_from_the_lower_left_on(decimate: int) -> None:
    picture = grey(5)
    height, width = picture.shape
    (found,) = apriltag.Detector(decimate).detect(picture.tobytes(), width, height)
    assert found.number == 5
    assert found.corners == pytest.approx(np.array([(28, 92), (92, 92), (92, 28), (28, 28)]), abs=0.5)


def test_a_picture_of_another_size_than_told_is_refused() -> None:
    with pytest.raises(ValueError, match="no picture of 20 x 20"):
        apriltag.Detector(1).detect(b"x" * 399, 20, 20)


def test_without_the_library_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise OSError(name)

    apriltag._library.cache_clear()
    monkeypatch.setattr(ctypes, "CDLL", missing)
    with pytest.raises(apriltag.AprilTagError, match="it comes with Debian's package python3-apriltag"):
        apriltag.Detector(1)


@pytest.mark.parametrize("floor", [Size(1.6, 1.2), Size(1.0, 0.8), Size(4, 4), Size(2, 7)])
def test_floor_tags_surround_the_floor_without_lying_on_it(floor: Size) -> None:
    tags = floor_tags(floor)
    assert list(tags) == list(range(FIRST_FLOOR_TAG, FIRST_FLOOR_TAG + len(tags)))
    assert len(tags) >= 6
    places = [(tag.x, tag.y) for tag in tags.values()]
    right, upper = round(floor.width + OUTSIDE, 3), round(floor.height + OUTSIDE, 3)
    assert {(-OUTSIDE, -OUTSIDE), (right, -OUTSIDE), (right, upper), (-OUTSIDE, upper)} <= set(places)
    for (x, y), following in zip(places, places[1:] + places[:1], strict=True):
        assert x in (-OUTSIDE, right) or y in (-OUTSIDE, upper)
        assert math.dist((x, y), following) <= SPACING
