"""How a robot moves by its commands: the standard robot's wheels, as its firmware turns them. Pure.

Times in s, of a clock that only goes on; places in m, headings in rad counter-clockwise from x.
"""

import math
from collections import deque
from typing import NamedTuple

FULL_SPEED = 1024 / 4096 * math.pi * 0.09  # m/s of a wheel: half-steps/s, half-steps of a turn, its diameter
INNER = 0.7  # of it, of the inner wheel in a curve
TRACK = 0.12  # m between the wheels
DEAD_MAN = 0.32  # s after the last command until a robot stops
KEPT = 3.0  # s that commands are remembered


class Place(NamedTuple):
    x: float
    y: float
    heading: float


class Wheels(NamedTuple):
    """Their speeds in m/s, forward."""

    left: float
    right: float


STILL = Wheels(0, 0)


def wheels_of(linear_x: int, angular_z: int) -> Wheels:
    """What the firmware makes of a command: 1 is forward, and to the right."""
    if linear_x in (1, -1):
        speed = linear_x * FULL_SPEED
        return Wheels(speed * (INNER if angular_z == -1 else 1), speed * (INNER if angular_z == 1 else 1))
    turn = angular_z * FULL_SPEED if linear_x == 0 and angular_z in (1, -1) else 0
    return Wheels(turn, -turn)


class Commands:
    """What one robot was told lately."""

    def __init__(self) -> None:
        self._told: deque[tuple[float, float, Wheels]] = deque()  # from, until

    def hear(self, linear_x: int, angular_z: int, now: float) -> None:
        wheels = wheels_of(linear_x, angular_z)
        since = now
        if self._told:
            began, end, before = self._told.pop()
            if before == wheels and now <= end:
                since = began
            else:
                self._told.append((began, min(end, now), before))
        self._told.append((since, now + DEAD_MAN, wheels))
        while self._told[0][1] < now - KEPT:
            self._told.popleft()

    def move(self, place: Place, since: float, until: float) -> Place:
        """Where a robot is at `until` that was at `place` at `since`, if nothing is in its way."""
        for began, end, wheels in self._told:
            seconds = min(until, end) - max(since, began)
            if seconds > 0:
                place = roll(place, wheels.left * seconds, wheels.right * seconds)
        return place


def roll(place: Place, left: float, right: float) -> Place:
    """After the wheels have rolled so many m forward: along an arc."""
    turn = (right - left) / TRACK
    half = turn / 2
    chord = (left + right) / 2 * (math.sin(half) / half if half else 1.0)
    direction = place.heading + half
    return Place(
        place.x + chord * math.cos(direction),
        place.y + chord * math.sin(direction),
        math.remainder(place.heading + turn, math.tau),
    )
