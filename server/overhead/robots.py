"""Where each robot is, by its tag: believed when it is seen again, kept for a moment when it is covered. Pure.

Times in s, of a clock that only goes on; places in m, headings in rad counter-clockwise from x.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from laser_bot_battle.geometry import FULL_SPEED, Pose
from server.overhead.motion import Commands

REPEATS = 3  # pictures in a row that must show a robot where it was not expected
NEAR = 0.06  # m from where it was expected, when it was just seen there,
FASTER = 3 * FULL_SPEED  # m/s by which that grows: others push it, and wheels slip
COVERED = 1.0  # s for which the place of a robot that is not seen is predicted
MISSED = 0.25  # s; until then, it has only been missed in a picture or two
STALE = 0.6  # s; the newest picture is so old that no robot is seen


class Seen(NamedTuple):
    """A robot that has a place."""

    robot: int  # ID
    place: Pose
    covered: bool  # it is not seen, and the place is what its commands make of the last one


@dataclass
class _Robot:
    commands: Commands = field(default_factory=Commands)
    place: Pose | None = None
    seen: float = float("-inf")  # there
    rumour: Pose | None = None  # somewhere else
    rumoured: float = float("-inf")
    repeats: int = 0


class Robots:
    """By ID."""

    def __init__(self) -> None:
        self._robots: dict[int, _Robot] = {}
        self._newest = float("-inf")  # picture

    def command(self, robot: int, linear_x: int, angular_z: int, now: float) -> None:
        """It is told to move so."""
        self._robot(robot).commands.hear(linear_x, angular_z, now)

    def see(self, found: Mapping[int, Sequence[Pose]], taken: float) -> None:
        """Where a picture of that time shows each robot; several places for one are doubtful."""
        self._newest = taken
        for robot, places in found.items():
            one = self._robot(robot)
            expected = self._at(one, taken)
            if expected is not None:
                near = [place for place in places if _near(place, expected, taken - one.seen)]
                if len(near) == 1:
                    one.place, one.seen, one.repeats = near[0], taken, 0
                    continue
            if len(places) == 1:
                self._rumour(one, places[0], taken)

    def at(self, now: float) -> list[Seen]:
        """Where all robots are."""
        places = ((robot, one, self._at(one, now)) for robot, one in sorted(self._robots.items()))
        return [
            Seen(robot, place, self._newest - one.seen > MISSED or now - one.seen > STALE)
            for robot, one, place in places
            if place is not None
        ]

    def forget(self) -> None:
        """All places: nobody can say any more what the picture shows."""
        for one in self._robots.values():
            one.place, one.repeats = None, 0

    def _robot(self, robot: int) -> _Robot:
        return self._robots.setdefault(robot, _Robot())

    def _at(self, one: _Robot, now: float) -> Pose | None:
        if one.place is None or now - one.seen > COVERED:
            return None
        return one.commands.move(one.place, one.seen, now)

    def _rumour(self, one: _Robot, place: Pose, taken: float) -> None:
        """Believed when it repeats: a robot is put down somewhere, a false one appears once."""
        again = one.rumour is not None and _near(place, one.rumour, taken - one.rumoured)
        one.repeats = one.repeats + 1 if again and taken - one.rumoured <= COVERED else 1
        one.rumour, one.rumoured = place, taken
        if one.repeats >= REPEATS:
            one.place, one.seen, one.repeats = place, taken, 0


def _near(place: Pose, expected: Pose, seconds: float) -> bool:
    return math.dist(place.point, expected.point) <= NEAR + FASTER * max(0.0, seconds)
