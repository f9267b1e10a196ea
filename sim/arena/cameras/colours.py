"""Colours: those of the pages (server/static/js/arena), as red, green, blue from 0 to 255."""

from typing import NamedTuple

import numpy as np

from sim.arena.cameras.optics import Floats

PALETTE = ("#2de2ff", "#ffb52d", "#3dffa2", "#c77dff", "#ff7a3d", "#5b8cff", "#f2ff5c", "#ff7de0")  # robots, by number


class Colour(NamedTuple):
    red: float
    green: float
    blue: float

    def times(self, factor: float) -> "Colour":
        """Darker, or brighter up to white."""
        return Colour(*(min(255.0, channel * factor) for channel in self))

    def mixed(self, other: "Colour", share: float) -> "Colour":
        """With `share` of another colour in it."""
        return Colour(*(mine * (1 - share) + its * share for mine, its in zip(self, other, strict=True)))

    @property
    def light(self) -> Floats:
        """To be mixed with pixels: 3 x 1 x 1."""
        return np.array(self, np.float32)[:, None, None]

    @property
    def rgb(self) -> tuple[int, int, int]:
        return round(self.red), round(self.green), round(self.blue)


def colour(code: str) -> Colour:
    """Of "#rrggbb"."""
    return Colour(*bytes.fromhex(code[1:]))


def robot_colour(number: int) -> Colour:
    return colour(PALETTE[number % len(PALETTE)])


WHITE = colour("#ffffff")
OUTER = colour("#2d9bff")  # the outer walls' tubes
INNER = colour("#b14dff")
BEAM = colour("#ff3d6e")
GRID = colour("#5e82dc")
RING = colour("#2de2ff")
FOG = colour("#070b18")
