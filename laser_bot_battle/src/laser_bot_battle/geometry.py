"""Sizes of the robot, plane geometry, and motion from wheel rotation. Lengths in m, angles in rad.

The origin is the bottom left corner, x goes right, y up; heading 0 looks along +x, positive is counter-clockwise.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from laser_bot_battle import floor

HALF_STEPS_PER_TURN = 4096  # of a wheel on a 28BYJ-48 geared stepper, half-step drive
WHEEL_DIAMETER = 0.09  # 1024 half-steps/s are then 7.07 cm/s
TRACK = 0.12  # between the two wheels' contact points
ROBOT_RADIUS = floor.ROBOT_RADIUS
EMITTER_OFFSET = 0.06  # IR emitter, ahead of the centre; inside the chassis, so that no wall comes between

METRES_PER_HALF_STEP = math.pi * WHEEL_DIAMETER / HALF_STEPS_PER_TURN
FULL_SPEED = 1024 * METRES_PER_HALF_STEP  # m/s of a wheel that a command turns
INNER = 0.7  # of it: the inner wheel's in a curve

Point = tuple[float, float]
Wall = floor.Wall


@dataclass(frozen=True)
class Pose:
    """Where a robot's centre is and where it looks."""

    x: float
    y: float
    heading: float

    @property
    def point(self) -> Point:
        return self.x, self.y

    @property
    def emitter(self) -> Point:
        """Position of the IR emitter."""
        return self.x + EMITTER_OFFSET * math.cos(self.heading), self.y + EMITTER_OFFSET * math.sin(self.heading)


def wrap(angle: float) -> float:
    """The same direction within [-pi, pi]."""
    return math.remainder(angle, math.tau)


def bearing(start: Point, end: Point) -> float:
    """Direction from `start` to `end`."""
    return math.atan2(end[1] - start[1], end[0] - start[0])


def wheel_speeds(linear_x: int, angular_z: int) -> tuple[float, float]:
    """m/s forward of the left and the right wheel, as the firmware's movement table has them for a command: 1 is
    forward, and clockwise; other numbers than -1, 0 and 1 move nothing."""
    if linear_x in (1, -1):
        speed = linear_x * FULL_SPEED
        return speed * (INNER if angular_z == -1 else 1), speed * (INNER if angular_z == 1 else 1)
    turn = angular_z * FULL_SPEED if linear_x == 0 and angular_z in (1, -1) else 0.0
    return turn, -turn


def roll(pose: Pose, left: float, right: float) -> Pose:
    """Pose after the wheels have rolled `left` and `right` m forward at constant speeds: an exact circular arc."""
    turn = (right - left) / TRACK
    arc = (left + right) / 2
    half = turn / 2
    chord = arc * (math.sin(half) / half if half else 1.0)
    return Pose(
        pose.x + chord * math.cos(pose.heading + half),
        pose.y + chord * math.sin(pose.heading + half),
        wrap(pose.heading + turn),
    )


def nearest_on_wall(point: Point, wall: Wall) -> Point:
    """The point of a wall that is nearest to `point`."""
    x1, y1, x2, y2 = wall
    dx, dy = x2 - x1, y2 - y1
    length2 = dx * dx + dy * dy
    along = ((point[0] - x1) * dx + (point[1] - y1) * dy) / length2 if length2 else 0.0
    along = min(1.0, max(0.0, along))
    return x1 + along * dx, y1 + along * dy


def ray_to_wall(origin: Point, direction: Point, wall: Wall) -> float:
    """Distance along a ray (unit `direction`) to a wall; infinity if the ray misses it."""
    x1, y1, x2, y2 = wall
    wx, wy = x2 - x1, y2 - y1
    cross = direction[0] * wy - direction[1] * wx
    if abs(cross) < 1e-12:
        return math.inf
    ox, oy = x1 - origin[0], y1 - origin[1]
    distance = (ox * wy - oy * wx) / cross
    along = (ox * direction[1] - oy * direction[0]) / cross
    return distance if distance >= 0 and 0 <= along <= 1 else math.inf


def ray_to_disc(origin: Point, direction: Point, centre: Point, radius: float = ROBOT_RADIUS) -> float:
    """Distance along a ray (unit `direction`) to a disc, 0 from inside it; infinity if the ray misses it."""
    ox, oy = centre[0] - origin[0], centre[1] - origin[1]
    ahead = ox * direction[0] + oy * direction[1]
    outside2 = ox * ox + oy * oy - radius * radius
    if outside2 <= 0:
        return 0.0
    under_root = ahead * ahead - outside2
    return ahead - math.sqrt(under_root) if ahead > 0 and under_root >= 0 else math.inf


def free_distance(origin: Point, angle: float, walls: Iterable[Wall], robots: Iterable[Point], limit: float) -> float:
    """How far (m, at most `limit`) a ray goes before a wall or a robot (given by its centre) ends it."""
    direction = (math.cos(angle), math.sin(angle))
    distance = limit
    for wall in walls:
        distance = min(distance, ray_to_wall(origin, direction, wall))
    for robot in robots:
        distance = min(distance, ray_to_disc(origin, direction, robot))
    return distance
