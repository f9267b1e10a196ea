"""Light that lies over the picture: lamps, beams, and what a hit leaves."""

import math
from typing import NamedTuple

import numpy as np

from sim.arena.cameras.colours import BEAM, WHITE, Colour
from sim.arena.cameras.optics import CAMERA_HEIGHT, FOCAL, HEIGHT, NEAR, WIDTH, Floats, pixel_of

BEAM_HEIGHT = 0.058  # m, of the emitter over the floor
BEAM_WIDTH = 0.0015  # m, half of it
HALO = 6.0  # times that, where its light ends
REACH = 3.2  # radii of a glow until nothing is left of it
MOST = 30.0  # pixels of radius; more would only dazzle
END = 1 / (1 + REACH**2)  # what would be left


class Glow(NamedTuple):
    """A lamp. Lengths in m; half of the light is within `radius`."""

    depth: float
    side: float
    height: float
    radius: float
    colour: Colour
    strength: float

    def paint(self, canvas: Floats, hidden: Floats) -> None:
        """`hidden`: from which depth on each column is (m)."""
        if self.depth < NEAR:
            return
        column, row = pixel_of(self.depth, self.side, self.height)
        radius = max(0.8, min(self.radius / self.depth * FOCAL, MOST))
        reach = radius * REACH
        left, right = max(0, math.floor(column - reach)), min(WIDTH, math.ceil(column + reach) + 1)
        top, bottom = max(0, math.floor(row - reach)), min(HEIGHT, math.ceil(row + reach) + 1)
        if left >= right or top >= bottom:
            return
        x = (np.arange(left, right, dtype=np.float32) - column) / radius
        y = (np.arange(top, bottom, dtype=np.float32)[:, None] - row) / radius
        light = np.maximum(1 / (1 + x * x + y * y) - END, 0)
        light *= self.strength * (hidden[left:right] >= self.depth)
        canvas[:, top:bottom, left:right] += light * self.colour.light


class Beam(NamedTuple):
    """A shot, from where it leaves to where it ends: depth and side of both (m)."""

    start: tuple[float, float]
    end: tuple[float, float]

    def paint(self, canvas: Floats, hidden: Floats) -> None:
        """It rises a little on its way: to the camera's height, where the picture's middle is."""
        ends = self._ahead()
        if ends is None:
            return
        (depth1, x1, y1), (depth2, x2, y2) = ends
        margin = 2 + HALO * min(BEAM_WIDTH * FOCAL / min(depth1, depth2), 4.5)
        left, right = max(0, int(min(x1, x2) - margin)), min(WIDTH, int(max(x1, x2) + margin) + 1)
        top, bottom = max(0, int(min(y1, y2) - margin)), min(HEIGHT, int(max(y1, y2) + margin) + 1)
        if left >= right or top >= bottom:
            return
        x = np.arange(left, right, dtype=np.float32) - x1
        y = np.arange(top, bottom, dtype=np.float32)[:, None] - y1
        wide, high = x2 - x1, y2 - y1
        share = np.clip((x * wide + y * high) / max(wide * wide + high * high, 1e-6), 0, 1)
        across, up = x - share * wide, y - share * high
        away = np.sqrt(across * across + up * up)
        nearness = 1 / depth1 + share * (1 / depth2 - 1 / depth1)  # it is what grows evenly in the picture
        thick = np.clip(BEAM_WIDTH * FOCAL * nearness, 0.7, 4.5)
        away /= thick
        light = np.maximum(1 / (1 + away * away) - 1 / (1 + HALO * HALO), 0)
        light *= hidden[left:right] * nearness > 0.97
        region = canvas[:, top:bottom, left:right]
        region += light * BEAM.times(0.9).light
        region += light * light * WHITE.mixed(BEAM, 0.25).light

    def _ahead(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """Depth, column and row of the ends of the part before the camera; None: nothing is."""
        (depth1, side1), (depth2, side2) = self.start, self.end
        nearest = 3 * NEAR
        if max(depth1, depth2) <= nearest:
            return None

        def at(share: float) -> tuple[float, float, float]:
            depth, side = depth1 + share * (depth2 - depth1), side1 + share * (side2 - side1)
            height = BEAM_HEIGHT + share * (CAMERA_HEIGHT - BEAM_HEIGHT)
            return depth, *pixel_of(depth, side, height)

        cut = (nearest - depth1) / (depth2 - depth1) if depth1 != depth2 else 0.0
        return at(cut if depth1 < nearest else 0.0), at(cut if depth2 < nearest else 1.0)
