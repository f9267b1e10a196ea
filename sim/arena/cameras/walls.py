"""The walls: panels with a neon tube along their top."""

from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from laser_bot_battle.geometry import Wall
from sim.arena.cameras.colours import INNER, OUTER, WHITE, Colour, colour
from sim.arena.cameras.optics import Camera, Floats
from sim.arena.cameras.rays import FAR, meet_walls
from sim.arena.cameras.scene import Room
from sim.arena.cameras.texture import Ripmap, blend
from sim.arena.cameras.upright import Upright

OUTER_HEIGHT, INNER_HEIGHT = 0.19, 0.13  # m; both hide robots from each other
TILE = 0.4  # m of wall that the texture shows: two panels
SIZE = (512, 256)  # texels of a tile
SCALE = 2  # the texture is drawn larger, for smooth edges


@dataclass(frozen=True)
class Kind:
    """Walls that look alike."""

    walls: list[Wall]
    height: float
    texture: Ripmap

    def seen(self, camera: Camera) -> Upright:
        met = meet_walls(camera, self.walls)
        return Upright(
            first=0,
            depth=met.depth,
            cover=(met.depth < FAR).astype(np.float32),
            shade=0.55 + 0.45 * met.facing,
            across=met.along / TILE,
            across_step=met.step / TILE,
            texture=self.texture,
            bottom=0.0,
            top=self.height,
        )


class Walls:
    """All walls of a room."""

    def __init__(self, room: Room) -> None:
        outer = [wall for wall in room.walls if is_outer(wall, room)]
        inner = [wall for wall in room.walls if wall not in outer]
        self._outer = Kind(outer, OUTER_HEIGHT, Ripmap(_panels(OUTER)))
        self._inner = Kind(inner, INNER_HEIGHT, Ripmap(_panels(INNER)))

    def paint(self, canvas: Floats, camera: Camera) -> Floats:
        """Returns the depth of the inner walls, which hide robots (m, for each column; FAR: none)."""
        self._outer.seen(camera).paint(canvas)
        inner = self._inner.seen(camera)
        met = np.flatnonzero(inner.cover)
        if len(met):
            inner.paint(canvas)
        return inner.depth


def is_outer(wall: Wall, room: Room) -> bool:
    x1, y1, x2, y2 = wall
    return (x1 == x2 and x1 in (0, room.width)) or (y1 == y2 and y1 in (0, room.height))


def _panels(neon: Colour) -> Floats:
    width, height = SIZE[0] * SCALE, SIZE[1] * SCALE
    paint, light = Image.new("RGB", (width, height)), Image.new("RGB", (width, height))
    draw, shine = ImageDraw.Draw(paint), ImageDraw.Draw(light)
    for y in range(height):
        metal = colour("#2a3760").mixed(colour("#0c1226"), y / height).mixed(neon, 0.06)
        draw.line((0, y, width, y), metal.rgb)
    for panel in range(2):
        left, right = panel * width // 2, (panel + 1) * width // 2 - 1
        draw.rectangle((left, 0, left + 5, height), "#05070f")
        draw.rectangle((left + 6, 0, left + 9, height), "#3c4d80")
        _inset(draw, (left + 44, 96), (right - 36, height - 96), neon)
        _chevrons(shine, left, height, neon)
    shine.rectangle((0, 18, width, 42), neon.times(0.9).rgb)
    shine.rectangle((0, 26, width, 34), neon.mixed(WHITE, 0.85).rgb)
    shine.rectangle((0, height - 40, width, height - 32), neon.times(0.55).rgb)
    draw.rectangle((0, 0, width, 17), "#0b1020")
    draw.rectangle((0, height - 14, width, height), "#04060c")
    return blend(paint, light, SIZE, 9)


def _inset(draw: ImageDraw.ImageDraw, start: tuple[int, int], end: tuple[int, int], neon: Colour) -> None:
    """A sunk plate with cut corners."""
    (left, top), (right, bottom), cut = start, end, 30
    outline = [
        (left + cut, top), (right, top), (right, bottom - cut),
        (right - cut, bottom), (left, bottom), (left, top + cut),
    ]  # fmt: skip
    draw.polygon(outline, colour("#17213f").mixed(neon, 0.08).rgb)
    draw.line([*outline[:3]], "#060a16", 7)
    draw.line([*outline[3:], outline[0]], "#4a5f99", 5)


def _chevrons(shine: ImageDraw.ImageDraw, left: int, height: int, neon: Colour) -> None:
    for step in range(3):
        x, y, size = left + 170 + 74 * step, height // 2 + 6, 46
        corners = [(x - size, y - size), (x, y), (x - size, y + size)]
        shine.line(corners, neon.times(0.25 + 0.15 * step).rgb, 17, joint="curve")
