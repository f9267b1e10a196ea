"""What is painted onto the picture: printed tags, and discs. Colours are luminance and the two colour differences."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from laser_bot_battle.tags import tag_picture
from sim.arena.cameras.colours import Colour
from sim.arena.overhead.lens import Floats

TEXELS = 14  # of a tag's cell, in a row
BORDER = 14  # around a tag, in which its edge blurs
BLACK, WHITE = 28, 225  # luminance of print and paper


class Plate:
    """A square tag with its white border, `cell` m wide in each of its cells, as a camera with such pixels sees it."""

    def __init__(self, number: int, cell: float, pixel: float) -> None:
        blur = ImageFilter.BoxBlur(max(0.0, (pixel / cell * TEXELS - 1) / 2))
        cells = np.array(tag_picture(number), np.uint8)
        self._cells = len(cells)
        print_ = np.kron(np.where(cells, WHITE, BLACK).astype(np.uint8), np.ones((TEXELS, TEXELS), np.uint8))
        self._light = _blurred(np.pad(print_, BORDER, constant_values=WHITE), blur)
        self._cover = _blurred(np.pad(np.full_like(print_, 255), BORDER), blur) / np.float32(255)
        self._texels = TEXELS / cell

    @property
    def reach(self) -> float:
        """m from the middle to a corner."""
        return math.sqrt(2) * (self._cells / 2 * TEXELS + BORDER) / self._texels

    def paint(self, pixels: Floats, x: Floats, y: Floats, heading: float, gain: Floats) -> None:
        """Onto `pixels` (3 x rows x columns), which are at `x`, `y` (m) from its middle; its upper edge points to
        `heading`."""
        cosine, sine = math.cos(heading) * self._texels, math.sin(heading) * self._texels
        last = len(self._light) - 1
        row = np.clip((last + 1) / 2 - (x * cosine + y * sine), 0, last).astype(np.intp)
        column = np.clip((last + 1) / 2 + (x * sine - y * cosine), 0, last).astype(np.intp)
        cover = self._cover[row, column]
        pixels[0] += cover * (self._light[row, column] * gain - pixels[0])
        pixels[1:] += cover * (128 - pixels[1:])


@cache
def plate(number: int, cell: float, pixel: float) -> Plate:
    return Plate(number, cell, pixel)


def blend(pixels: Floats, cover: Floats, colour: Floats, gain: Floats) -> None:
    pixels[0] += cover * (colour[0] * gain - pixels[0])
    pixels[1:] += cover * (colour[1:, None, None] - pixels[1:])


def ycc(colour: Colour) -> Floats:
    """As a JPEG has it."""
    red, green, blue = colour
    light = 0.299 * red + 0.587 * green + 0.114 * blue
    return np.array([light, 128 + 0.564 * (blue - light), 128 + 0.713 * (red - light)], np.float32)


def _blurred(texels: NDArray[np.uint8], blur: ImageFilter.BoxBlur) -> Floats:
    return np.asarray(Image.fromarray(texels).filter(blur), np.float32)
