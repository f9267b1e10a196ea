"""IR light: a cone from the emitter in a robot's nose, ended by walls and by other robots.

The receiver sees all around, so light anywhere on the chassis counts: what the page draws as lit is lit.
"""

import math
from collections.abc import Sequence

from laser_bot_battle.geometry import (
    ROBOT_RADIUS,
    Point,
    Pose,
    Wall,
    bearing,
    free_distance,
    ray_to_disc,
    wrap,
)

BEAM_RANGE = 0.9  # m from the emitter
BEAM_HALF_ANGLE = math.radians(8)
RAYS = 9  # tried across the part of the cone that covers a target; at 0.9 m at most 2 cm apart


def shines_on(shooter: Pose, target: Point, walls: Sequence[Wall], others: Sequence[Point]) -> bool:
    """Whether the beam of `shooter` falls on the robot at `target`; `others` are the remaining robots' centres."""
    origin = shooter.emitter
    distance = math.dist(origin, target)
    if distance > BEAM_RANGE + ROBOT_RADIUS:
        return False
    covered = math.asin(min(1.0, ROBOT_RADIUS / distance)) if distance else math.pi
    off_axis = wrap(bearing(origin, target) - shooter.heading)
    low = max(off_axis - covered, -BEAM_HALF_ANGLE)
    high = min(off_axis + covered, BEAM_HALF_ANGLE)
    if low >= high:
        return False
    for ray in range(RAYS):
        angle = shooter.heading + low + (high - low) * (ray + 0.5) / RAYS
        reached = ray_to_disc(origin, (math.cos(angle), math.sin(angle)), target)
        if reached <= BEAM_RANGE and free_distance(origin, angle, walls, others, BEAM_RANGE) >= reached:
            return True
    return False
