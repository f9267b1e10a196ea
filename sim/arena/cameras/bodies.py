"""The robots that one sees: a round base, and a turret on it with a lamp."""

import math
from typing import NamedTuple

import numpy as np

from laser_bot_battle.geometry import ROBOT_RADIUS, wrap
from sim.arena.cameras.colours import BEAM, WHITE, Colour, robot_colour
from sim.arena.cameras.glow import Glow
from sim.arena.cameras.optics import CAMERA_HEIGHT, COLUMNS, FOCAL, MIDDLE_X, MIDDLE_Y, NEAR, ROWS, Camera, Floats
from sim.arena.cameras.rays import meet_disc
from sim.arena.cameras.robot_textures import LID, look_of
from sim.arena.cameras.scene import Body
from sim.arena.cameras.texture import Ripmap
from sim.arena.cameras.upright import GLOW_HAZE, HAZE, Upright

BASE_BOTTOM, BASE_TOP = 0.008, 0.052  # m over the floor
TURRET_RADIUS, TURRET_TOP = 0.052, 0.105
MAST_TOP = 0.119  # where the lamp is that tells how the robot is
RIM = 0.95  # radii of the base from which on its top shines


class Seen(NamedTuple):
    """A robot before the camera."""

    body: Body
    depth: float  # m, of its centre
    side: float
    angle: float  # rad: from its front to where the camera is, counter-clockwise

    @property
    def colour(self) -> Colour:
        return robot_colour(self.body.number)


def seen_of(camera: Camera, body: Body) -> Seen:
    depth, side = camera.see(body.x, body.y)
    place = camera.place
    towards = math.atan2(place[1] - body.y, place[0] - body.x)
    return Seen(body, depth, side, wrap(towards - body.heading))


def paint_robot(canvas: Floats, seen: Seen, hidden: Floats) -> Floats:
    """`hidden`: from which depth on each column is (m). Returns the same with this robot before it."""
    look = look_of(seen.colour, "?" if seen.body.id is None else str(seen.body.id)[-2:])
    base = _round(seen, ROBOT_RADIUS, (BASE_BOTTOM, BASE_TOP), look.base, hidden)
    if base is None:
        return hidden
    base.paint(canvas)
    _paint_lid(canvas, seen, look.lid, hidden)
    turret = _round(seen, TURRET_RADIUS, (BASE_TOP, TURRET_TOP), look.turret, hidden)
    if turret is not None:
        turret.paint(canvas)
    nearer = hidden.copy()
    columns = nearer[base.first : base.first + len(base.depth)]
    columns[base.cover > 0.5] = base.depth[base.cover > 0.5]
    return nearer


def lamps(seen: Seen) -> list[Glow]:
    """What shines on a robot: the lamp on its mast, its emitter while it shoots, and the light that a hit leaves."""
    found = []
    body = seen.body
    if seen.depth > NEAR:
        status = BEAM if body.lit else seen.colour
        found.append(Glow(seen.depth, seen.side, MAST_TOP, 0.0075, status.mixed(WHITE, 0.4), 1.5))
        if body.lit:
            found.append(Glow(seen.depth, seen.side, 0.06, 0.05, BEAM.mixed(WHITE, 0.1), 0.75))
    return found


def _round(seen: Seen, radius: float, span: tuple[float, float], texture: Ripmap, hidden: Floats) -> Upright | None:
    """What stands around a robot's middle, over a `span` of heights (m)."""
    met = meet_disc(seen.depth, seen.side, radius)
    if not len(met.depth):
        return None
    columns = slice(met.first, met.first + len(met.depth))
    cover = met.cover * (hidden[columns] > met.depth)
    if not cover.any():
        return None
    around = met.angle + (seen.angle - _offset(seen))
    across = (0.5 + around * (1 / math.tau)) % 1
    step = np.abs(np.gradient(met.angle)) if len(met.angle) > 1 else np.ones(1, np.float32)
    aslant = np.cos(met.angle - _offset(seen))
    return Upright(
        first=met.first,
        depth=met.depth,
        cover=cover,
        shade=(0.35 + 0.75 * np.clip(aslant, 0, 1) ** 1.3).astype(np.float32),
        across=across.astype(np.float32),
        across_step=(step / math.tau).astype(np.float32),
        texture=texture,
        bottom=span[0],
        top=span[1],
        tint=BEAM.mixed(WHITE, 0.25) if seen.body.lit else None,
    )


def _offset(seen: Seen) -> float:
    """The angle of meet_disc() at which the point nearest to the camera is."""
    return -math.atan2(seen.side, seen.depth)


def _paint_lid(canvas: Floats, seen: Seen, lid: Floats, hidden: Floats) -> None:
    """The base's top, which the camera looks down upon."""
    fall = CAMERA_HEIGHT - BASE_TOP
    near, far = max(NEAR, seen.depth - ROBOT_RADIUS), seen.depth + ROBOT_RADIUS
    rows = slice(max(0, int(MIDDLE_Y + fall / far * FOCAL)), min(len(ROWS), int(MIDDLE_Y + fall / near * FOCAL) + 2))
    sides = [(seen.side + reach) / near for reach in (-ROBOT_RADIUS, ROBOT_RADIUS)]
    left = int(np.clip(MIDDLE_X + sides[0] * FOCAL, 0, len(COLUMNS)))
    right = int(np.clip(MIDDLE_X + sides[1] * FOCAL + 2, 0, len(COLUMNS)))
    if rows.start >= rows.stop or left >= right:
        return
    depth = fall / np.maximum(ROWS[rows, None], 1e-6)
    ahead = (depth - seen.depth) / ROBOT_RADIUS
    aside = (depth * COLUMNS[left:right] - seen.side) / ROBOT_RADIUS
    away = np.sqrt(ahead * ahead + aside * aside)
    # pixels of a radius: fewer ahead, where one looks along the lid
    sharp = away * ROBOT_RADIUS * FOCAL / (np.abs(aside) * depth + np.abs(ahead) * depth**2 / fall + 1e-6)
    cover = np.clip((1 - away) * sharp + 0.5, 0, 1) * (hidden[left:right] > depth)
    # into the robot's own directions, ahead and left
    turn = seen.angle + math.pi - _offset(seen)
    cosine, sine = math.cos(turn), math.sin(turn)
    own_ahead, own_left = ahead * cosine + aside * sine, ahead * sine - aside * cosine
    index = ((own_ahead + 1) * (LID / 2)).astype(np.intp).clip(0, LID - 1) * LID
    index += ((own_left + 1) * (LID / 2)).astype(np.intp).clip(0, LID - 1)
    sampled = lid.take(index, axis=1)
    texels, light = sampled[:3], sampled[3]
    shade, glow = 0.9 * math.exp(-HAZE * seen.depth), math.exp(-GLOW_HAZE * seen.depth)
    light *= glow - shade
    light += shade
    rim = np.clip((away - RIM) * sharp + 0.5, 0, 1)
    texels *= light
    texels += rim * (seen.colour.times(glow).light - texels)
    region = canvas[:, rows, left:right]
    region += cover * (texels - region)
