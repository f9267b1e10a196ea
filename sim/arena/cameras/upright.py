"""Painting what stands upright, column by column, with its reflection in the floor."""

from dataclasses import dataclass

import numpy as np

from sim.arena.cameras.colours import Colour
from sim.arena.cameras.optics import CAMERA_HEIGHT, FOCAL, MIDDLE_Y, ROWS, Floats
from sim.arena.cameras.texture import Ripmap

MIRROR = 0.30  # how much of the light the floor reflects
MIRROR_FADE = 6.0  # 1/m: the higher up, the less
HAZE = 0.55  # 1/m: how the light of what only reflects it fades with the distance
TINT = 0.45  # how much of its colour it loses for its tint
GLOW_HAZE = 0.22  # 1/m: how that of lamps fades


@dataclass(frozen=True)
class Upright:
    """A surface in the columns from `first` on. Arrays have a value for each of them."""

    first: int
    depth: Floats  # m
    cover: Floats  # 0 to 1
    shade: Floats  # 0 to 1: how much light falls on it
    across: Floats  # of the texture, whose width is 1
    across_step: Floats  # from one column to the next
    texture: Ripmap
    bottom: float  # m over the floor
    top: float
    tint: Colour | None = None  # of what is hit

    def paint(self, canvas: Floats) -> None:
        """Over what is on the canvas already."""
        highest = MIDDLE_Y - (self.top - CAMERA_HEIGHT) * FOCAL / self.depth
        lowest = MIDDLE_Y + (self.top + CAMERA_HEIGHT) * FOCAL / self.depth
        rows = slice(max(0, int(highest.min()) - 1), min(len(ROWS), int(min(lowest.max(), 1e4)) + 2))
        if rows.start >= rows.stop:
            return
        region = canvas[:, rows, self.first : self.first + len(self.depth)]
        pixel = self.depth / FOCAL  # m
        inverse = 1 / pixel
        height = CAMERA_HEIGHT - ROWS[rows, None] * self.depth
        distance = np.abs(height)  # from the floor, also for what is reflected
        alpha = np.clip((self.top - distance) * inverse + 0.5, 0, 1)
        if self.bottom:
            alpha *= np.clip((distance - self.bottom) * inverse + 0.5, 0, 1)
        itself = np.clip(height * inverse + 0.5, 0, 1)
        alpha *= itself + (1 - itself) * np.maximum(MIRROR - MIRROR * MIRROR_FADE * distance, 0)
        alpha *= self.cover
        distance -= self.bottom
        np.maximum(distance, 0, out=distance)
        distance *= 1 / (self.top - self.bottom)
        sampled = self.texture.sample(self.across, self.across_step, distance, pixel / (self.top - self.bottom))
        texels, light = sampled[:3], sampled[3]
        shade = self.shade * np.exp(-HAZE * self.depth)
        light *= np.exp(-GLOW_HAZE * self.depth) - shade
        light += shade
        texels *= light
        if self.tint:
            texels += (self.tint.light - texels) * TINT
        texels -= region
        texels *= alpha
        region += texels
