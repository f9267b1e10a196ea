"""From a picture to places: the tags are really looked for."""

import math

import numpy as np
import pytest

from server.overhead.eye import Looker, PictureError
from server.overhead.tracker import Tracker
from tests.support.overhead_camera import SIZE, TAG_HEIGHT, OverheadCamera, grey_picture, jpeg_of

ROBOTS = {1: (0.3, 0.4, 0.5), 2: (3.7, 2.0, -2.0), 3: (2.0, 1.0, math.pi)}


@pytest.fixture(scope="module")
def looker() -> Looker:
    return Looker()


def test_robots_are_found_in_a_picture_with_tilt_lens_and_noise(looker: Looker) -> None:
    camera = OverheadCamera(x=2.1, y=1.0, z=2.9, tilt=6, turn=3, focal_length=1.15, bend=-0.1)
    tracker = Tracker(camera.floor, camera.z, TAG_HEIGHT)
    jpeg = jpeg_of(grey_picture(camera.floor_tags() + camera.robots(ROBOTS), noise=6))
    tags, size = looker.tags(jpeg)
    assert size == SIZE
    for tick in range(3):
        tracker.see(tags, size, 100 + tick / 15)
    found = {seen.robot: seen.place for seen in tracker.robots(100.2)}
    assert found.keys() == ROBOTS.keys()
    for robot, (x, y, heading) in ROBOTS.items():
        assert math.dist(found[robot].point, (x, y)) < 0.006
        assert abs(math.remainder(found[robot].heading - heading, math.tau)) < math.radians(2)


def test_a_picture_of_nothing_has_no_tags(looker: Looker) -> None:
    noise = np.random.default_rng(4).integers(0, 255, (480, 640)).astype(np.uint8)
    assert looker.tags(jpeg_of(noise)) == ([], (640, 480))


def test_what_is_no_picture_or_one_of_a_wrong_size_says_so(looker: Looker) -> None:
    jpeg = jpeg_of(grey_picture([]))
    with pytest.raises(PictureError, match="broken pictures"):
        looker.tags(jpeg[:200] + jpeg[-2:])
    with pytest.raises(PictureError, match="of 4000 x 2000 are too large"):
        looker.tags(jpeg_of(np.zeros((2000, 4000), np.uint8)))
    with pytest.raises(PictureError, match="of 100 x 1 are too small"):
        looker.tags(jpeg_of(np.zeros((1, 100), np.uint8)))
