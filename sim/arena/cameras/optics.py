"""The camera in a robot's nose: where it is, and which ray belongs to which pixel. Lengths in m.

A point before the camera has the coordinates depth (ahead), side (to the right) and height over the floor. It is seen
`side / depth` to the right of the picture's middle and `(CAMERA_HEIGHT - height) / depth` below it, times FOCAL.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from laser_bot_battle.geometry import EMITTER_OFFSET, Point

Floats = NDArray[np.floating[Any]]  # float32 wherever there are many

WIDTH, HEIGHT = 320, 240  # pixels
FOCAL = 160.0  # pixels; the picture is 90 degrees wide
CAMERA_HEIGHT = 0.08
NEAR = 0.01  # what is less ahead is not seen

MIDDLE_X, MIDDLE_Y = (WIDTH - 1) / 2, (HEIGHT - 1) / 2
COLUMNS: Floats = ((np.arange(WIDTH) - MIDDLE_X) / FOCAL).astype(np.float32)  # side / depth of each column
ROWS: Floats = ((np.arange(HEIGHT) - MIDDLE_Y) / FOCAL).astype(np.float32)  # fall / depth of each row


@dataclass(frozen=True)
class Camera:
    """Of a robot whose centre is at (`x`, `y`): level, over the laser, looking where it points."""

    x: float
    y: float
    heading: float

    @property
    def forward(self) -> Point:
        return math.cos(self.heading), math.sin(self.heading)

    @property
    def right(self) -> Point:
        return math.sin(self.heading), -math.cos(self.heading)

    @property
    def place(self) -> Point:
        """Of the lens."""
        ahead = self.forward
        return self.x + EMITTER_OFFSET * ahead[0], self.y + EMITTER_OFFSET * ahead[1]

    def see(self, x: float, y: float) -> Point:
        """Depth and side of a point of the floor."""
        place, forward, right = self.place, self.forward, self.right
        east, north = x - place[0], y - place[1]
        return east * forward[0] + north * forward[1], east * right[0] + north * right[1]


def pixel_of(depth: float, side: float, height: float) -> Point:
    """Where a point is in the picture (column, row), which may be outside of it."""
    return MIDDLE_X + side / depth * FOCAL, MIDDLE_Y + (CAMERA_HEIGHT - height) / depth * FOCAL
