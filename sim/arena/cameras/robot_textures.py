"""How a robot looks from all sides: its base with wheels and lamps, and its turret with a face and its number."""

import math
from functools import lru_cache
from typing import NamedTuple

from PIL import Image, ImageDraw

from sim.arena.cameras.colours import BEAM, WHITE, Colour, colour
from sim.arena.cameras.digits import draw_number
from sim.arena.cameras.optics import Floats
from sim.arena.cameras.texture import Ripmap, blend, planes_of

BASE_SIZE, TURRET_SIZE = (512, 64), (512, 64)  # texels: once around x the height
LID = 160  # texels of the base's top, along its diameter
SCALE = 3
WHEEL_ASPECT = 0.8  # of a circle: texels are wider than high
KEPT = 16  # robots whose looks are kept: more than the floor has room for

Draw = ImageDraw.ImageDraw


class Look(NamedTuple):
    """Of one robot. The middle of what goes around is its front; towards the right is its left side."""

    base: Ripmap
    turret: Ripmap
    lid: Floats  # 4 x (LID * LID): rows go ahead, columns to the left


@lru_cache(KEPT)
def look_of(body: Colour, number: str) -> Look:
    """`number`: what stands on it."""
    return Look(Ripmap(_base(body, number)), Ripmap(_turret(body, number)), _lid(body))


def _canvases(size: tuple[int, int], top: Colour, bottom: Colour) -> tuple[Image.Image, Image.Image, Draw, Draw]:
    width, height = size[0] * SCALE, size[1] * SCALE
    paint, light = Image.new("RGB", (width, height)), Image.new("RGB", (width, height))
    draw = ImageDraw.Draw(paint)
    for y in range(height):
        draw.line((0, y, width, y), top.mixed(bottom, y / height).rgb)
    return paint, light, draw, ImageDraw.Draw(light)


def _base(body: Colour, number: str) -> Floats:
    paint, light, draw, shine = _canvases(BASE_SIZE, body.times(0.85), body.times(0.32))
    width, height = paint.size
    shine.rectangle((0, 0, width, 9), body.rgb)
    draw.rectangle((0, height * 0.80, width, height), "#0c1122")
    shine.rectangle((0, height * 0.88, width, height * 0.93), body.times(0.8).rgb)
    for side in (0.25, 0.75):
        _wheel(draw, shine, (width * side, height * 0.56), height * 0.43, body)
    middle = width / 2
    draw.rounded_rectangle((middle - 100, 22, middle + 100, height * 0.76), 24, "#0a1020")
    shine.ellipse((middle - 15, 34, middle + 15, 62), BEAM.mixed(WHITE, 0.2).rgb)  # the emitter
    draw_number(draw, number, (middle, 106), 56, "#eaf2ff")
    for back in (0, width):  # it goes around the seam
        draw.rounded_rectangle((back - 150, 44, back + 150, 126), 16, "#0a1020")
        for lamp in (-110, 70):
            shine.rectangle((back + lamp, 62, back + lamp + 40, 82), "#ff2d2d")
    return blend(paint, light, BASE_SIZE, 3)


def _wheel(draw: Draw, shine: Draw, middle: tuple[float, float], radius: float, body: Colour) -> None:
    x, y = middle
    across = radius * WHEEL_ASPECT

    def ring(share: float) -> tuple[float, float, float, float]:
        return x - across * share, y - radius * share, x + across * share, y + radius * share

    draw.ellipse(ring(1), "#05070d")
    draw.ellipse(ring(0.86), "#3a4770")
    draw.ellipse(ring(0.66), "#0b1020")
    for spoke in range(5):
        angle = math.tau * (spoke + 0.25) / 5
        draw.line((x, y, x + 0.7 * across * math.cos(angle), y + 0.7 * radius * math.sin(angle)), "#a9b6dd", 9)
    shine.ellipse(ring(0.24), body.times(0.8).rgb)


def _turret(body: Colour, number: str) -> Floats:
    paint, light, draw, shine = _canvases(TURRET_SIZE, colour("#56648f"), colour("#1d2746"))
    width, height = paint.size
    draw.rectangle((0, 0, width, 16), body.rgb)
    shine.rectangle((0, height - 12, width, height), body.times(0.7).rgb)
    for step in (1, 2, 3, 4, 5):  # a number to each sixth of the circle, but the face to the front
        middle = width * (0.5 + step / 6) % width
        for x in (middle - width, middle, middle + width):  # the one at the back goes around the seam
            draw.rounded_rectangle((x - 100, 30, x + 100, height - 24), 22, "#060a16")
            draw.rounded_rectangle((x - 100, 30, x + 100, height - 24), 22, None, body.times(0.8).rgb, 5)
            draw_number(shine, number, (x, (height + 6) / 2), 96, "#eef4ff")
    _face(draw, shine, width / 2, height, body)
    return blend(paint, light, TURRET_SIZE, 3)


def _face(draw: Draw, shine: Draw, middle: float, height: int, body: Colour) -> None:
    draw.rounded_rectangle((middle - 120, 34, middle + 120, height - 40), 44, "#04060d")
    draw.rounded_rectangle((middle - 120, 34, middle + 120, height - 40), 44, None, "#7d8cbd", 5)
    for eye in (-58, 58):
        shine.rounded_rectangle(
            (middle + eye - 26, 62, middle + eye + 26, height - 68), 22, body.mixed(WHITE, 0.55).rgb
        )


def _lid(body: Colour) -> Floats:
    """As on the arena's page: an arrowhead that points ahead."""
    size = LID * SCALE
    paint = Image.new("RGB", (size, size), body.times(0.35).mixed(colour("#141d38"), 0.5).rgb)
    light = Image.new("RGB", (size, size))
    half = size / 2

    def place(ahead: float, left: float) -> tuple[float, float]:
        return half + left * half, half - ahead * half  # blend() turns it upside down

    arrow = [place(0.97, 0), place(0.45, 0.55), place(0.62, 0), place(0.45, -0.55)]
    ImageDraw.Draw(light).polygon(arrow, body.rgb)
    return planes_of(blend(paint, light, (LID, LID), 2))
