"""The printed tags that a camera above the floor knows robots and the floor by: AprilTags of the family tag36h11.

A robot's tag has the robot's ID for its number. Floor tags lie around the floor, where no robot drives, from
`FIRST_FLOOR_TAG` on.
"""

import math
from typing import NamedTuple, Protocol

from laser_bot_battle.apriltag import TAGS, tag_picture
from laser_bot_battle.names import ROBOT_IDS

__all__ = ["FIRST_FLOOR_TAG", "FLOOR_TAGS", "FLOOR_TAG_SIZE", "ROBOT_TAG_SIZE", "TagPose", "floor_tags", "tag_picture"]

ROBOT_TAG_SIZE = 0.10  # m, the edge of the black square
FLOOR_TAG_SIZE = 0.10
FIRST_FLOOR_TAG = 200  # above every robot's ID
FLOOR_TAGS = range(FIRST_FLOOR_TAG, TAGS)
# m from the edge of the floor to a floor tag's centre: its white border is not on the floor, and a low outer wall
# does not hide it from a camera above the middle
OUTSIDE = 0.15
SPACING = 2.0  # m between two floor tags, at most

assert ROBOT_IDS[-1] < FIRST_FLOOR_TAG


class Rectangle(Protocol):
    """A floor, as far as it matters here."""

    @property
    def width(self) -> float: ...
    @property
    def height(self) -> float: ...


class TagPose(NamedTuple):
    """How a tag lies: its centre in m from the floor's lower left corner, x to the right and y up; `heading` in rad,
    counter-clockwise from x, is where the upper edge of the tag as printed points."""

    x: float
    y: float
    heading: float


def floor_tags(floor: Rectangle) -> dict[int, TagPose]:
    """Where each floor tag lies: counter-clockwise around the floor, the first at the lower left corner, with upper
    edges along y. All corners, the middle of the long sides, and as many more as keep them `SPACING` apart."""
    left, lower, right, upper = -OUTSIDE, -OUTSIDE, floor.width + OUTSIDE, floor.height + OUTSIDE
    corners = [(left, lower), (right, lower), (right, upper), (left, upper)]
    longest = max(right - left, upper - lower)
    places = []
    for (x1, y1), (x2, y2) in zip(corners, corners[1:] + corners[:1], strict=True):
        length = math.dist((x1, y1), (x2, y2))
        # the camera must tell where the floor is when somebody stands on a corner
        gaps = max(math.ceil(length / SPACING), 2 if length == longest else 1)
        places += [(x1 + (x2 - x1) * gap / gaps, y1 + (y2 - y1) * gap / gaps) for gap in range(gaps)]
    return {
        number: TagPose(round(x, 3), round(y, 3), math.pi / 2)  # to the mm, as they are laid out
        for number, (x, y) in zip(FLOOR_TAGS, places, strict=False)
    }
