"""How a bot plays: from what it sees to what it commands. Pure; made to be beaten by people.

It sees others late, aims badly, waits between shots, sometimes drives elsewhere instead of fighting, and leaves alone
for a while whoever was hit: several bots are no worse for somebody than one.
"""

import math
import random
from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from laser_bot_battle.geometry import Point, Pose, bearing, free_distance, wrap
from server.bots.paths import Paths

AIM_TOLERANCE = math.radians(6)  # a robot turns 2.7 degrees in one command's time, and stops some commands late
FIRE_RANGE = 0.75  # m
CLOSE = 0.35  # m; nearer than this it does not drive at its opponent
TRIGGER = 0.12  # s that a shot is commanded, so that a lost command does not lose it
ROAM = (1.5, 3.0)  # s of driving elsewhere
ARRIVED = 0.04  # m
TURN_FIRST = 0.6  # rad off its path: turn in place
ABOUT = 0.3  # rad from the direction behind: there, one side is as near as the other, and the last one stays
CURVE = 0.12  # rad off its path: correct while driving
REPLAN = 0.3  # s until a path is planned again
STUCK_AFTER = 0.8  # s of driving
STUCK_WITHIN = 0.03  # m; where it is to be goes a little ahead of where it was seen
BACK_OFF = (0.5, 1.0)  # s


@dataclass(frozen=True)
class Command:
    """What a Robot_msg carries: linear_x 1 = forward, angular_z 1 = clockwise, shoot."""

    linear_x: int = 0
    angular_z: int = 0
    shoot: bool = False


NEUTRAL = Command()


@dataclass(frozen=True)
class Skill:
    """How good a player is."""

    mercy: float = 3.0  # s from the start of a battle to the first shot
    reaction: float = 0.4  # s from an event until the bot sees it
    aim_error: float = math.radians(14)  # standard deviation of a shot's direction
    reload: tuple[float, float] = (1.7, 3.2)  # s between two shots
    rest: tuple[float, float] = (0.6, 1.5)  # s of standing still after a shot
    roam_chance: float = 0.45  # of driving elsewhere after a shot
    spare: float = 0.0  # s for which it leaves alone who was hit, by whomever


FAIR = Skill()  # alone, it takes 60 to 90 s for somebody who does nothing
# with a hit that takes 10 of 100 life, nobody is out in less than nine times `spare`
SKILLS = {
    "easy": Skill(5.0, 0.6, math.radians(20), (2.4, 4.5), (1.0, 2.0), 0.6, 8.0),
    "fair": FAIR,
    "hard": Skill(1.5, 0.25, math.radians(5), (0.8, 1.2), (0.1, 0.4), 0.2),
}


class Mind:
    """One bot on one floor. Times are s of any steady clock, never going back."""

    def __init__(self, paths: Paths, chance: random.Random, skill: Skill = FAIR) -> None:
        self._paths = paths
        self._chance = chance
        self._skill = skill
        self._places = paths.places()
        self._views: deque[tuple[float, Mapping[int, Point]]] = deque()
        self._aim_error = 0.0
        self._side = -1  # of the last turn
        self._next_shot: float | None = None  # not before this; None until the first look
        self._trigger_until = 0.0
        self._rest_until = 0.0
        self._roam_until = 0.0
        self._roam_to: Point = (0.0, 0.0)
        self._back_off_until = 0.0
        self._back_off = NEUTRAL
        self._path: tuple[float, Point] = (-math.inf, (0.0, 0.0))
        self._drive_began: tuple[float, Point] | None = None

    def decide(
        self,
        now: float,
        me: Pose,
        others: Mapping[int, Point],
        opponents: Collection[int],
        hit_at: Mapping[int, float] = MappingProxyType({}),
        *,
        protection: float = 0.0,
    ) -> Command:
        """The command for this moment. `others`: where the other robots are, by ID; `opponents`: the living of them;
        `hit_at`: when which robots were last hit; `protection`: s for which nobody can be hit."""
        if self._next_shot is None:
            self._next_shot = now + self._skill.mercy
        self._next_shot = max(self._next_shot, now + protection)
        spared = {number for number, at in hit_at.items() if now - at < self._skill.spare}
        command = self._choose(now, me, self._seen(now, others), opponents, spared)
        if self._is_stuck(now, me, command):
            side = self._chance.choice((-1, 1))
            self._back_off = Command(-command.linear_x, side)
            self._back_off_until = now + self._chance.uniform(*BACK_OFF)
            self._roam(self._back_off_until)
            return self._back_off
        return command

    def _choose(
        self, now: float, me: Pose, seen: Mapping[int, Point], opponents: Collection[int], spared: Collection[int]
    ) -> Command:
        if now < self._trigger_until:
            return Command(shoot=True)
        if now < self._back_off_until:
            return self._back_off
        if now < self._rest_until:
            return NEUTRAL
        if now < self._roam_until:
            return NEUTRAL if math.dist(me.point, self._roam_to) < ARRIVED else self._drive_to(now, me, self._roam_to)
        alive = [number for number in opponents if number in seen]
        targets = [number for number in alive if number not in spared]
        if alive and not targets:
            self._roam(now)
        if not targets:
            return NEUTRAL
        target = min(targets, key=lambda number: math.dist(me.point, seen[number]))
        return self._hunt(now, me, seen[target], [seen[number] for number in seen if number != target])

    def _hunt(self, now: float, me: Pose, target: Point, bystanders: Collection[Point]) -> Command:
        distance = math.dist(me.point, target)
        direction = bearing(me.point, target)
        in_sight = free_distance(me.point, direction, self._paths.walls, bystanders, distance) >= distance
        if not in_sight or distance > FIRE_RANGE:
            return self._drive_to(now, me, target)
        off = wrap(direction + self._aim_error - me.heading)
        if abs(off) > AIM_TOLERANCE:
            return self._turn(off)
        if self._next_shot is not None and now >= self._next_shot:
            self._fire(now)
            return Command(shoot=True)
        return Command(linear_x=1) if distance > CLOSE else NEUTRAL

    def _fire(self, now: float) -> None:
        """Shoot, and plan what comes after: some rest or a drive elsewhere."""
        self._trigger_until = now + TRIGGER
        self._next_shot = now + self._chance.uniform(*self._skill.reload)
        self._aim_error = self._chance.gauss(0, self._skill.aim_error)
        self._rest_until = now + self._chance.uniform(*self._skill.rest)
        if self._chance.random() < self._skill.roam_chance:
            self._roam(self._rest_until)

    def _roam(self, start: float) -> None:
        if self._places:
            self._roam_to = self._chance.choice(self._places)
            self._roam_until = start + self._chance.uniform(*ROAM)

    def _drive_to(self, now: float, me: Pose, goal: Point) -> Command:
        planned, point = self._path
        if now - planned > REPLAN:
            point = self._paths.next_point(me.point, goal)
            self._path = (now, point)
        off = wrap(bearing(me.point, point) - me.heading)
        if abs(off) > TURN_FIRST:
            return self._turn(off)
        return Command(1, self._turn(off).angular_z if abs(off) > CURVE else 0)

    def _seen(self, now: float, others: Mapping[int, Point]) -> Mapping[int, Point]:
        """What the bot knows now of the others: what could be seen a reaction time ago."""
        self._views.append((now, dict(others)))
        while len(self._views) > 1 and self._views[1][0] <= now - self._skill.reaction:
            self._views.popleft()
        seen, view = self._views[0]
        return view if seen <= now - self._skill.reaction else {}

    def _is_stuck(self, now: float, me: Pose, command: Command) -> bool:
        """Whether the robot has been driving without moving."""
        if command.linear_x == 0 or now < self._back_off_until:
            self._drive_began = None
            return False
        if self._drive_began is None or math.dist(self._drive_began[1], me.point) > STUCK_WITHIN:
            self._drive_began = (now, me.point)
        if now - self._drive_began[0] < STUCK_AFTER:
            return False
        self._drive_began = None
        return True

    def _turn(self, off: float) -> Command:
        """Turn in place towards a direction that is `off` rad counter-clockwise."""
        if abs(off) < math.pi - ABOUT:
            self._side = -1 if off > 0 else 1
        return Command(angular_z=self._side)
