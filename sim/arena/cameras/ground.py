"""The floor: dark, with a grid, rings in its middle, the walls' light, and the robots' shadows and lamps."""

import math

import numpy as np

from laser_bot_battle.geometry import ROBOT_RADIUS, Wall
from sim.arena.cameras.bodies import Seen
from sim.arena.cameras.colours import GRID, INNER, OUTER, RING
from sim.arena.cameras.optics import CAMERA_HEIGHT, COLUMNS, FOCAL, HEIGHT, NEAR, ROWS, Camera, Floats
from sim.arena.cameras.scene import Room
from sim.arena.cameras.texture import planes_of
from sim.arena.cameras.walls import is_outer

FIRST = HEIGHT // 2  # row, the first below the horizon
TEXEL = 0.004  # m; what the texture holds is blurred, and the sharp lines are drawn by themselves
CELL = 0.1  # m of the grid
LINE, RING_LINE = 0.0014, 0.003  # m, half the width
RINGS = (0.2, 0.215)  # m
SHADOW = 0.15  # m around a robot's centre that its shadow and its lamps reach

_DEPTH: Floats = (CAMERA_HEIGHT / ROWS[FIRST:, None]).astype(np.float32)  # m, of each row
_SIDE: Floats = _DEPTH * COLUMNS
_ROW_STEP: Floats = _DEPTH**2 / (CAMERA_HEIGHT * FOCAL)  # m of depth from one row to the next
_COLUMN_STEP: Floats = _DEPTH / FOCAL
_FADE: Floats = np.exp(-0.5 * _DEPTH)


class Ground:
    def __init__(self, room: Room) -> None:
        self._room = room
        texels = _light(room)
        self._columns = texels.shape[1]
        self._texels = planes_of(texels)

    def paint(self, canvas: Floats, camera: Camera, others: list[Seen]) -> None:
        """Everything below the horizon."""
        (east, north), forward, right = camera.place, camera.forward, camera.right
        x = (forward[0] * _DEPTH + east) + right[0] * _SIDE
        y = (forward[1] * _DEPTH + north) + right[1] * _SIDE
        np.clip(x, 0, self._room.width - 1e-4, out=x)
        np.clip(y, 0, self._room.height - 1e-4, out=y)
        index = (y * (1 / TEXEL)).astype(np.intp)
        index *= self._columns
        index += (x * (1 / TEXEL)).astype(np.intp)
        floor = self._texels.take(index, axis=1)
        lines = self._grid(x, camera.forward[0], camera.right[0]) + self._grid(y, camera.forward[1], camera.right[1])
        floor += lines * GRID.times(0.62).light
        rings = self._rings(x, y)
        floor += rings * RING.times(0.45).light
        floor *= _FADE
        for seen in others:
            _shadow(floor, x, y, seen)
        canvas[:, FIRST:] = floor

    def _grid(self, place: Floats, forward: float, right: float) -> Floats:
        """How bright the lines across one axis are; `place` on it, whose parts of the camera's axes these are."""
        width = np.abs(forward + right * COLUMNS) * _ROW_STEP + abs(right) * _COLUMN_STEP  # of a pixel
        cells = place * (1 / CELL)
        return _line(np.abs(cells - np.rint(cells)) * CELL, width, LINE)

    def _rings(self, x: Floats, y: Floats) -> Floats:
        radius = _length(x - self._room.width / 2, y - self._room.height / 2)
        width = 0.5 * (_ROW_STEP + _COLUMN_STEP)
        away = np.minimum(np.abs(radius - RINGS[0]), np.abs(radius - RINGS[1]))
        return _line(away, width, RING_LINE / 2)


def _shadow(floor: Floats, x: Floats, y: Floats, seen: Seen) -> None:
    """Under a robot, and the light of the lamps below it; `x` and `y` are the places of the floor's pixels (m)."""
    body, depth, side, colour = seen.body, seen.depth, seen.side, seen.colour
    if depth + SHADOW <= NEAR:
        return
    near, far = max(NEAR, depth - SHADOW), depth + SHADOW
    first = int(CAMERA_HEIGHT / far * FOCAL)
    last = int(min(CAMERA_HEIGHT / near * FOCAL, HEIGHT)) + 1
    sides = [(side + reach) / there for reach in (-SHADOW, SHADOW) for there in (near, far)]
    left = int(np.clip((min(sides) - COLUMNS[0]) * FOCAL, 0, len(COLUMNS)))
    right = int(np.clip((max(sides) - COLUMNS[0]) * FOCAL + 1, 0, len(COLUMNS)))
    region = np.s_[first:last, left:right]
    if first >= last or left >= right:
        return
    away = _length(x[region] - body.x, y[region] - body.y)
    part = floor[:, first:last, left:right]
    part *= np.clip((away - 0.6 * ROBOT_RADIUS) * (1 / (SHADOW - 0.6 * ROBOT_RADIUS)), 0.08, 1)
    lamps = 1 / (1 + ((away - ROBOT_RADIUS) * (1 / 0.018)) ** 2)
    lamps *= np.clip((SHADOW - away) * (1 / 0.05), 0, 1)
    lamps *= math.exp(-0.4 * max(depth, 0)) * (1.3 if body.lit else 0.55)
    part += lamps * colour.light


def _length(x: Floats, y: Floats) -> Floats:
    return np.sqrt(x * x + y * y)  # several times as fast as hypot


def _line(away: Floats, width: Floats, half: float) -> Floats:
    """How much of a pixel of this `width` a line fills whose middle is so far `away`; all in m."""
    filled = (half + 0.5 * width - away) / width
    return np.clip(filled, 0, np.minimum(1, 2 * half / width))


def _light(room: Room) -> Floats:
    """The floor's own colour and the light of the walls on it: rows from y = 0 on x columns x 3."""
    x = (np.arange(math.ceil(room.width / TEXEL)) + 0.5) * TEXEL
    y = ((np.arange(math.ceil(room.height / TEXEL)) + 0.5) * TEXEL)[:, None]
    middle = np.hypot(x - room.width / 2, y - room.height / 2) / (0.65 * room.width)
    texels = np.zeros((len(y), len(x), 3), np.float32)
    for share, code in ((0.0, (30, 44, 84)), (0.6, (18, 28, 57)), (1.0, (10, 15, 33))):
        weight = np.clip(1 - np.abs(middle - share) / (0.6 if share < 0.6 else 0.4), 0, 1)
        texels += weight[..., None] * np.array(code, np.float32)
    for wall in room.walls:
        away = distance(x, y, wall)
        neon = OUTER if is_outer(wall, room) else INNER
        texels *= (1 - 0.75 * np.exp(-away / 0.012))[..., None]
        texels += (0.34 * np.exp(-away / 0.05) * (1 - np.exp(-away / 0.008)))[..., None] * np.array(neon, np.float32)
    return texels


def distance(x: Floats, y: Floats, wall: Wall) -> Floats:
    """From each point to a wall."""
    x1, y1, x2, y2 = wall
    length2 = (x2 - x1) ** 2 + (y2 - y1) ** 2
    along = np.clip(((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / length2, 0, 1)
    return np.hypot(x - x1 - along * (x2 - x1), y - y1 - along * (y2 - y1))
