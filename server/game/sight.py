"""Where the robots were seen of late, by /positions, and what follows from that. Pure; nothing is decided here.

Lengths in m, angles in rad, counter-clockwise from x, times in monotonic seconds. What is not seen is not known:
whoever asks then hears that everything may be.
"""

import math
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from laser_bot_battle.floor import ROBOT_RADIUS
from server.game.emitter import DELAY, PULSE

Point = tuple[float, float]
Pose = tuple[float, float, float]  # x, y, heading
Wall = tuple[float, float, float, float]  # from x, y to x, y

# Half the cone in which a robot's light may be seen. Real emitters and their holders differ, and a robot is seen with
# an error of some degrees: the rule is there for light from elsewhere, not for near misses.
BEAM = math.radians(25)
# A hit may be reported so long after the robots stood so: the light, its news, and the age of what a camera tells.
REMEMBERED = PULSE + DELAY + 0.4
MOST = 100  # moments that are remembered

LINE = 0.02  # before the floor's edge, at which a robot is stopped: it moves on by some mm until it is
SLANT = math.sin(math.radians(10))  # who drives along the edge, or a little towards it, is not stopped
# A camera sees a robot at a slightly different place in each picture, so one that is stopped is let go a little later.
FREE_LINE = LINE + 0.015
FREE_SLANT = math.sin(math.radians(5))


@dataclass(frozen=True, slots=True)
class Sides:
    """Where a robot may not drive on, since it would leave the floor."""

    ahead: bool = False
    behind: bool = False


FREE = Sides()


@dataclass(frozen=True, slots=True)
class Moment:
    """What was seen at once."""

    at: float
    walls: tuple[Wall, ...]
    poses: Mapping[int, Pose]  # by robot


class Sight:
    """What was seen of late, the newest last."""

    def __init__(self) -> None:
        self._moments: deque[Moment] = deque(maxlen=MOST)

    def see(self, moment: Moment) -> None:
        self._moments.append(moment)
        while self._moments[0].at < moment.at - REMEMBERED:
            self._moments.popleft()

    def may_have_met(self, shooter: int, victim: int, reach: float, now: float) -> bool:
        """Whether light of one robot, which reaches so far, may have met the other a moment ago."""
        seen = [
            (one.poses[shooter], one.poses[victim], one.walls)
            for one in self._moments
            if one.at >= now - REMEMBERED and shooter in one.poses and victim in one.poses
        ]
        return not seen or any(could_meet(*one, reach) for one in seen)


def could_meet(shooter: Pose, victim: Pose, walls: Iterable[Wall], reach: float) -> bool:
    """Whether the shooter's beam reaches some part of the victim."""
    x, y, heading = shooter
    ahead, aside = victim[0] - x, victim[1] - y
    distance = math.hypot(ahead, aside)
    if distance <= 2 * ROBOT_RADIUS:  # they touch
        return True
    if distance > reach + ROBOT_RADIUS:
        return False
    off = abs(math.remainder(math.atan2(aside, ahead) - heading, math.tau))
    if off > BEAM + math.asin(ROBOT_RADIUS / distance):
        return False
    across = (-aside / distance * ROBOT_RADIUS * 0.9, ahead / distance * ROBOT_RADIUS * 0.9)
    targets = [(victim[0] + part * across[0], victim[1] + part * across[1]) for part in (0.0, 1.0, -1.0)]
    walls = tuple(walls)
    return any(not any(_crosses((x, y), target, wall) for wall in walls) for target in targets)


def beyond(pose: Pose, width: float, height: float, stopped: Sides = FREE) -> Sides:
    """Where the robot would leave a floor of that size; `stopped`: where it has been stopped until now."""
    return Sides(
        _leaves(pose, width, height, 1, stopped.ahead),
        _leaves(pose, width, height, -1, stopped.behind),
    )


def _leaves(pose: Pose, width: float, height: float, way: int, is_stopped: bool) -> bool:
    """Forwards (1) or backwards (-1)."""
    x, y, heading = pose
    line, slant = (FREE_LINE, FREE_SLANT) if is_stopped else (LINE, SLANT)
    along, up = way * math.cos(heading), way * math.sin(heading)
    # towards each edge: how far the robot's rim is from it, and how much of its way leads there
    edges = ((x, -along), (width - x, along), (y, -up), (height - y, up))
    return any(distance - ROBOT_RADIUS < line and towards > slant for distance, towards in edges)


def _crosses(start: Point, end: Point, wall: Wall) -> bool:
    """Whether the way from one point to another is blocked."""
    x1, y1, x2, y2 = wall
    return _side(start, end, (x1, y1)) * _side(start, end, (x2, y2)) < 0 and (
        _side((x1, y1), (x2, y2), start) * _side((x1, y1), (x2, y2), end) < 0
    )


def _side(start: Point, end: Point, point: Point) -> float:
    return (end[0] - start[0]) * (point[1] - start[1]) - (end[1] - start[1]) * (point[0] - start[0])
