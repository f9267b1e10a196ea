"""All that stands on the floor: robots that roll, collide, shine and are lit. Pure: everything happens at once."""

import math
import re
from collections.abc import Set
from dataclasses import dataclass, field

from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import METRES_PER_HALF_STEP, ROBOT_RADIUS, Point, Pose, nearest_on_wall, roll
from sim.arena.carrier import Carrier
from sim.arena.light import shines_on

MAX_ROBOTS = 8
MAX_REMEMBERED = 64  # robots that left and may come back to their place
MAX_JUMP = 20_000  # half-steps between two reports; 20 s of full speed, so more is no wheel's motion
STRIDE = 0.005  # m; longer motions are checked for collisions in pieces of this length
CONTACT_TURNS = 4  # times that a robot is pushed out of what it touches before it counts as wedged
FLASH = 0.15  # s that coded light is shown: its 25 ms are too short for eyes and for a view of 10 states a second
TOUCH = 1e-6  # m of overlap that is rounding, not contact


class ArenaError(Exception):
    """What a robot asked for cannot be; the text is for its operator."""


@dataclass
class Robot:
    """A robot on the floor. `wheels` is the last report in half-steps (left, right), None before the first."""

    name: str
    pose: Pose
    wheels: tuple[int, int] | None = None
    beam: bool = False
    lit: bool = False
    hits: int = 0
    carrier: Carrier = field(default_factory=Carrier)
    flash_until: float = -math.inf
    lit_until: float = -math.inf

    def is_shining(self, now: float) -> bool:
        """For people: a little longer than it is."""
        return self.beam or now < self.flash_until

    def is_lit(self, now: float) -> bool:
        """For people, likewise."""
        return self.lit or now < self.lit_until

    @property
    def id(self) -> int | None:
        """The number at the end of the name, if there is one."""
        digits = re.search(r"\d+$", self.name)
        return int(digits[0]) if digits else None


class World:
    """The floor and the robots on it."""

    def __init__(self, floor: Floor) -> None:
        self.floor = floor
        self.robots: dict[str, Robot] = {}
        self._away: dict[str, Robot] = {}

    def arrive(self, name: str) -> Robot:
        """Put a robot on the floor: where it left, else at the free start position farthest from all others.

        ArenaError if the floor is full, or stood upon wherever robots start.
        """
        if len(self.robots) >= MAX_ROBOTS:
            raise ArenaError(f"the arena is full ({MAX_ROBOTS} robots)")
        robot = self._away.pop(name, None)
        if robot is None:
            robot = Robot(name, self._free_spawn())
        elif not self._is_free(robot.pose.point, self._others(name)):
            robot.pose = self._free_spawn()
        self.robots[name] = robot
        return robot

    def leave(self, name: str) -> None:
        """Take a robot off the floor; its place and hits are kept for its return."""
        robot = self.robots.pop(name)
        robot.wheels, robot.beam, robot.lit, robot.carrier = None, False, False, Carrier()
        self._away[name] = robot
        while len(self._away) > MAX_REMEMBERED:
            del self._away[next(iter(self._away))]

    def turn_wheels(self, name: str, left: int, right: int) -> None:
        """The wheels' cumulative half-steps are now `left`, `right`; a robot's first report only sets the baseline.

        Forward is left negative, right positive, as the firmware drives. ArenaError if no wheel can have turned so far.
        """
        robot = self.robots[name]
        before, robot.wheels = robot.wheels, (left, right)
        if before is None:
            return
        ahead_left, ahead_right = before[0] - left, right - before[1]
        if max(abs(ahead_left), abs(ahead_right)) > MAX_JUMP:
            raise ArenaError(f"wheels cannot turn more than {MAX_JUMP} half-steps at once")
        self._drive(robot, ahead_left * METRES_PER_HALF_STEP, ahead_right * METRES_PER_HALF_STEP)

    def set_beam(self, name: str, on: bool) -> None:
        self.robots[name].beam = on

    def set_carrier(self, name: str, on: bool, cycle: int, now: float) -> list[tuple[Robot, bool]]:
        """The carrier is on or off at `cycle` of the robot's time; returns whom that concerns, and if they see it.

        A robot that has seen all of a packet has a hit more. `now` is of the arena's clock (s).
        """
        shooter = self.robots[name]
        carrier = shooter.carrier
        is_edge = on != carrier.on
        whole: Set[str] = frozenset()
        if is_edge and on:
            carrier.start(cycle, [robot.name for robot in self.robots.values() if self._meets(shooter, robot)])
        elif is_edge:
            whole = carrier.end(cycle)
        if is_edge:
            shooter.flash_until = now + FLASH
        watching = [robot for robot in self.robots.values() if robot.name in carrier.watched_by]
        for robot in watching:
            robot.hits += robot.name in whole
            if is_edge and robot.name in carrier.seen_by:
                robot.lit_until = now + FLASH
        return [(robot, on and robot.name in carrier.seen_by) for robot in watching]

    @property
    def any_light(self) -> bool:
        """Whether motion can change who is lit."""
        return any(robot.beam or robot.lit for robot in self.robots.values())

    def update_light(self) -> list[Robot]:
        """Find out who is lit now; returns the robots for which that has changed. A newly lit one has a hit more."""
        changed = []
        for robot in self.robots.values():
            lit = self._is_lit(robot)
            if lit != robot.lit:
                robot.lit = lit
                robot.hits += lit
                changed.append(robot)
        return changed

    def _is_lit(self, target: Robot) -> bool:
        return any(shooter.beam and self._meets(shooter, target) for shooter in self.robots.values())

    def _meets(self, shooter: Robot, target: Robot) -> bool:
        """Whether a beam of `shooter` falls on `target`."""
        others = [robot.pose.point for robot in self.robots.values() if robot is not shooter and robot is not target]
        return shooter is not target and shines_on(shooter.pose, target.pose.point, self.floor.walls, others)

    def _drive(self, robot: Robot, left: float, right: float) -> None:
        others = self._others(robot.name)
        pieces = max(1, math.ceil(max(abs(left), abs(right)) / STRIDE))
        for _ in range(pieces):
            wished = roll(robot.pose, left / pieces, right / pieces)
            x, y = self._push_out(wished.point, others) or robot.pose.point
            robot.pose = Pose(x, y, wished.heading)

    def _push_out(self, point: Point, others: list[Point]) -> Point | None:
        """`point` moved out of walls and other robots, so that a robot slides along them; None if it is wedged."""
        for _ in range(CONTACT_TURNS):
            moved = False
            obstacles = [(nearest_on_wall(point, wall), ROBOT_RADIUS) for wall in self.floor.walls]
            obstacles += [(other, 2 * ROBOT_RADIUS) for other in others]
            for (x, y), clearance in obstacles:
                distance = math.dist(point, (x, y))
                if 0 < distance < clearance - TOUCH:
                    scale = clearance / distance
                    point = (x + (point[0] - x) * scale, y + (point[1] - y) * scale)
                    moved = True
            if not moved:
                return point
        return point if self._is_free(point, others) else None

    def _is_free(self, point: Point, others: list[Point]) -> bool:
        walls_clear = all(
            math.dist(point, nearest_on_wall(point, wall)) >= ROBOT_RADIUS - TOUCH for wall in self.floor.walls
        )
        return walls_clear and all(math.dist(point, other) >= 2 * ROBOT_RADIUS - TOUCH for other in others)

    def _others(self, name: str) -> list[Point]:
        return [robot.pose.point for robot in self.robots.values() if robot.name != name]

    def _free_spawn(self) -> Pose:
        """The start position farthest from all robots; the first of them on an empty floor."""
        taken = [robot.pose.point for robot in self.robots.values()]

        def clearance(start: Pose) -> float:
            return min((math.dist(start.point, other) for other in taken), default=math.inf)

        best = max((Pose(*start) for start in self.floor.starts), key=clearance)
        if clearance(best) < ROBOT_RADIUS:
            raise ArenaError(f"robots stand on all {len(self.floor.starts)} start places")
        return best
