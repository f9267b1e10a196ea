"""What is above the walls: the night around the hall, which tells a driver where north is."""

import itertools
import math

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from sim.arena.ambient import Ambient
from sim.arena.cameras.colours import Colour, colour
from sim.arena.cameras.optics import COLUMNS, HEIGHT, ROWS, Camera, Floats
from sim.arena.cameras.texture import planes_of

TURN = 2048  # columns of a whole turn
RISE = 0.76  # the highest row's height by its distance
HIGH = 192  # rows
SCALE = 2
SKY = ((0.0, "#ff4fa0"), (0.05, "#a52f9c"), (0.16, "#4a1d7a"), (0.34, "#1c1347"), (0.7, "#0a0a24"), (1.0, "#05060f"))

_ROWS = HEIGHT // 2


class Backdrop:
    def __init__(self, ambient: Ambient) -> None:
        self._texels = planes_of(_panorama(ambient))
        # on a cylinder around the camera, a column's rows are the lower the farther it is aside
        up = -ROWS[:_ROWS, None] / np.sqrt(1 + COLUMNS**2)
        self._row = ((HIGH - 1) * (1 - up / RISE)).astype(np.intp) * TURN
        self._turn = np.arctan(COLUMNS) / math.tau * TURN

    def paint(self, canvas: Floats, camera: Camera) -> None:
        """Everything above the horizon."""
        column = (self._turn - camera.heading / math.tau * TURN).astype(np.intp) % TURN
        canvas[:, :_ROWS] = self._texels.take(self._row + column, axis=1)


def _panorama(ambient: Ambient) -> Floats:
    """Rows from the highest to the horizon x columns clockwise from east x 3."""
    width, height = TURN * SCALE, HIGH * SCALE
    sky = Image.new("RGB", (width, height))
    draw = ImageDraw.Draw(sky)
    for y in range(height):
        draw.line((0, y, width, y), _sky((height - 1 - y) / (height - 1)).rgb)
    chance = np.random.default_rng(3)
    _stars(draw, chance, width, height)
    _sun(sky, width, height, ambient.sun)
    _towers(sky, chance, width, height)
    if ambient.lamp:
        _lamps(sky, width, height)
    # as smooth as the coarsest pixels: those in the picture's middle
    return np.asarray(sky.filter(ImageFilter.GaussianBlur(2.2)).resize((TURN, HIGH), Image.Resampling.BOX), np.float32)


def _sky(up: float) -> Colour:
    for (low, below), (high, above) in itertools.pairwise(SKY):
        if up <= high:
            return colour(below).mixed(colour(above), (up - low) / (high - low))
    return colour(SKY[-1][1])


def _stars(draw: ImageDraw.ImageDraw, chance: np.random.Generator, width: int, height: int) -> None:
    for _ in range(420):
        x, y, light = chance.uniform(0, width), chance.uniform(0, height * 0.75), int(chance.uniform(40, 210))
        size = 1.0 if light < 200 else 2.0
        draw.ellipse((x - size, y - size, x + size, y + size), (light, light, min(255, light + 40)))


def _column(heading: float, width: int) -> float:
    """Of a direction (rad, counter-clockwise from east)."""
    return -heading / math.tau * width % width


def _sun(sky: Image.Image, width: int, height: int, shines: bool) -> None:
    """In the east, between its stripes; `shines`: too bright to look at."""
    x, radius = width // 2, 0.20 / math.tau * width
    y = height - 0.25 / RISE * height
    glow = Image.new("RGB", sky.size)
    far = radius * (2.2 if shines else 1.25)
    ImageDraw.Draw(glow).ellipse((x - far, y - far, x + far, y + far), (150, 110, 60) if shines else (90, 20, 70))
    glow = glow.filter(ImageFilter.GaussianBlur(radius * 0.45))
    disc = Image.new("RGB", sky.size)
    mask = Image.new("L", sky.size)
    paint = ImageDraw.Draw(disc)
    for row in range(int(y - radius), height):
        share = (row - y + radius) / (2 * radius)
        top, low = (colour("#fffbe6"), colour("#ffd23d")) if shines else (colour("#ffe45c"), colour("#ff2f8e"))
        paint.line((0, row, width, row), top.mixed(low, min(1, share)).rgb)
    ImageDraw.Draw(mask).ellipse((x - radius, y - radius, x + radius, y + radius), 255)
    stripes = ImageDraw.Draw(mask)
    for stripe in range(0 if shines else 5):
        start = y + radius * 0.2 * stripe
        stripes.rectangle((0, start, width, start + radius * (0.03 + 0.022 * stripe)), 0)
    east = Image.fromarray(np.minimum(np.asarray(sky, np.uint16) + np.asarray(_moved(glow, x)), 255).astype(np.uint8))
    sky.paste(east)
    sky.paste(_moved(disc, x), mask=_moved(mask, x))


def _moved(picture: Image.Image, x: int) -> Image.Image:
    """Turned so that column `x` becomes the first: the east."""
    return Image.fromarray(np.roll(np.asarray(picture), -x, axis=1))


def _towers(sky: Image.Image, chance: np.random.Generator, width: int, height: int) -> None:
    """North and south; lower towards the sun."""
    draw = ImageDraw.Draw(sky)
    lights = ("#ffd98a", "#2de2ff", "#ff7de0")
    x = 0.0
    while x < width:
        across = chance.uniform(36, 92)
        angle = math.tau * (x + across / 2) / width
        tall = 0.05 + 0.26 * abs(math.sin(angle)) ** 2.5 * chance.uniform(0.35, 1.0)
        top = height * (1 - tall)
        if abs(math.sin(angle)) > 0.35:
            draw.rectangle((x, top, x + across - 6, height), "#0a0a20")
            edge = lights[int(chance.integers(3))]
            draw.line((x, top, x + across - 6, top), colour(edge).times(0.8).rgb, 3)
        x += across


def _lamps(sky: Image.Image, width: int, height: int) -> None:
    """Tubes under the ceiling, all around."""
    light = Image.new("RGB", sky.size)
    draw = ImageDraw.Draw(light)
    for x in range(0, width, width // 12):
        draw.rounded_rectangle((x + 60, height * 0.25, x + 250, height * 0.25 + 16), 8, "#fff3d6")
    glow = np.asarray(light.filter(ImageFilter.GaussianBlur(26)), np.uint16) * 2 + np.asarray(light)
    sky.paste(Image.fromarray(np.minimum(np.asarray(sky) + glow, 255).astype(np.uint8)))
