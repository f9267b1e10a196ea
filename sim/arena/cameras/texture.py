"""Textures of what stands on the floor, and how they are sampled: smoothly, from any distance and however aslant."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from sim.arena.cameras.optics import Floats

LEVELS = 6  # of each direction, each half as fine as the one before


class Ripmap:
    """A texture with smaller and smaller versions of itself in both directions, which wraps around to its sides.

    Texels are red, green, blue (0 to 255) and glow (0 to 1: how much it shines by itself). The first row is the lowest.
    """

    def __init__(self, texels: Floats) -> None:
        """`texels`: rows x columns x 4; both are multiples of 2**(LEVELS - 1)."""
        self._rows, self._columns = texels.shape[:2]
        parts: list[Floats] = []
        self._start = np.zeros((LEVELS, LEVELS), np.intp)  # of the version by levels of column and row
        size = 0
        for row_level in range(LEVELS):
            narrow = texels
            for column_level in range(LEVELS):
                self._start[column_level, row_level] = size
                parts.append(planes_of(narrow))
                size += parts[-1].shape[1]
                narrow = (narrow[:, 0::2] + narrow[:, 1::2]) / 2
            texels = (texels[0::2] + texels[1::2]) / 2
        texels = np.concatenate(parts, axis=1)
        texels[3] *= 255
        self._texels = texels.round().astype(np.uint8)  # a quarter of the memory, and so of the time to get it

    def sample(self, across: Floats, across_step: Floats, up: Floats, up_step: Floats) -> Floats:
        """The texels (4 x rows x columns) at `up` (rows x columns) and `across` (for each column).

        Of the texture, whose height is 1 and whose width is 1. The steps are from one pixel of a column to its
        neighbours.
        """
        column_level = _level(across_step * self._columns)
        row_level = _level(up_step * self._rows)
        columns, rows = self._columns >> column_level, self._rows >> row_level
        column = (across * columns).astype(np.intp) % columns
        place = up * rows.astype(np.float32)
        place -= 0.5
        np.clip(place, 0, rows - 1.001, out=place)
        index = place.astype(np.intp)
        place -= index
        index *= columns
        index += self._start[column_level, row_level] + column
        texels = self._texels.take(index, axis=1).astype(np.float32)
        index += columns
        above = self._texels.take(index, axis=1) - texels
        above *= place
        texels += above
        texels[3] *= 1 / 255
        return texels


def planes_of(texels: Floats) -> Floats:
    """Channel x texel, of rows x columns x channel: NumPy is several times as fast with each channel by itself."""
    return np.ascontiguousarray(texels.reshape(-1, texels.shape[-1]).T, np.float32)


def _level(texels: Floats) -> NDArray[np.intp]:
    """The version in which so many texels of the finest one become about one."""
    levels: NDArray[np.intp] = np.clip(np.log2(np.maximum(texels, 1e-6)) + 0.3, 0, LEVELS - 1).astype(np.intp)
    return levels


def blend(paint: Image.Image, light: Image.Image, size: tuple[int, int], glow: float) -> Floats:
    """Texels of `size` (width, height) from pictures that are drawn upright: what is painted, and what shines.

    Its light also falls on what is within about `glow` texels around it.
    """
    halo = np.asarray(light.resize(size, Image.Resampling.BOX).filter(ImageFilter.GaussianBlur(glow)), np.float32)
    shining = np.asarray(light.resize(size, Image.Resampling.BOX), np.float32)
    painted = np.asarray(paint.resize(size, Image.Resampling.BOX), np.float32)
    brightness = np.clip(np.maximum(shining, halo).max(axis=2, keepdims=True) / 160, 0, 1)
    texels = np.concatenate([np.minimum(painted * (1 - 0.7 * brightness) + shining + halo, 255), brightness], axis=2)
    return np.ascontiguousarray(texels[::-1], np.float32)
