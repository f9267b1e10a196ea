"""How a robot moves by its commands: the standard robot's wheels, as its firmware turns them. Pure.

Times in s, of a clock that only goes on; places in m, headings in rad counter-clockwise from x.
"""

from collections import deque

from laser_bot_battle.geometry import Pose, roll, wheel_speeds

DEAD_MAN = 0.32  # s after the last command until a robot stops
KEPT = 3.0  # s that commands are remembered


class Commands:
    """What one robot was told lately."""

    def __init__(self) -> None:
        self._told: deque[tuple[float, float, tuple[float, float]]] = deque()  # from, until, wheels

    def hear(self, linear_x: int, angular_z: int, now: float) -> None:
        wheels = wheel_speeds(linear_x, angular_z)
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

    def move(self, place: Pose, since: float, until: float) -> Pose:
        """Where a robot is at `until` that was at `place` at `since`, if nothing is in its way."""
        for began, end, (left, right) in self._told:
            seconds = min(until, end) - max(since, began)
            if seconds > 0:
                place = roll(place, left * seconds, right * seconds)
        return place
