"""How the robots are, as they say themselves once a second: the newest of each. Pure, but for a lock."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from server.game.snapshot import Snapshot

FRESH = 5.0  # s that a report holds
SETTLING = 5.0  # s that a robot may be in another light than the rule's: it is told again after a reset
# The Arduino measures its supply by a reference of its own that is 10 % exact: what counts is the fall below what was
# usual at first.
FIRST = 60.0  # s
FALL = 0.08
LOW_SUPPLY = 4300  # mV, whatever was usual

WARNINGS = ("silent", "low_supply", "under_voltage", "deaf", "wrong_light")
_WEAK = {"low_supply", "under_voltage"}

Report = dict[str, Any]  # a laser_bot_battle/Health in JSON's types


@dataclass
class _Robot:
    """What is known of a robot since it has registered."""

    since: float  # its first report
    at: float = 0.0
    report: Report = field(default_factory=dict)  # the newest
    supplies: list[int] = field(default_factory=list)  # mV, of the first minute
    usual: float = 0.0  # their median; 0: not known yet
    wrong_since: float | None = None  # when it began to be in another light than it should be

    def hear(self, report: Report, coded: bool, now: float) -> None:
        self.at, self.report = now, report
        board = report["board"]
        is_coded = board is not None and bool(board["mode"])  # the original sketch knows plain light only
        if is_coded == coded:
            self.wrong_since = None
        elif self.wrong_since is None:
            self.wrong_since = now
        if now - self.since < FIRST:
            if board is not None and board["supply"]:
                self.supplies.append(board["supply"])
        elif self.supplies:
            self.usual, self.supplies = median(self.supplies), []

    def warnings(self, now: float) -> list[str]:
        if now - self.at > FRESH:
            return ["silent"]
        board = self.report["board"]
        low = max(LOW_SUPPLY, self.usual * (1 - FALL))
        signs = {
            "low_supply": board is not None and 0 < board["supply"] < low,
            "under_voltage": self.report["under_voltage"],
            "deaf": board is not None and board["deaf"],
            "wrong_light": self.wrong_since is not None and now - self.wrong_since >= SETTLING,
        }
        return [name for name, is_so in signs.items() if is_so]


class RobotsHealth:
    """For any thread."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._coded = False  # the rule
        self._robots: dict[int, _Robot] = {}

    def follow(self, snapshot: Snapshot) -> None:
        """A listener of the game."""
        with self._lock:
            if snapshot.coded != self._coded:
                self._coded = snapshot.coded
                for robot in self._robots.values():
                    robot.wrong_since = None  # it has not been told yet

    def report(self, robot_id: int, report: Report) -> None:
        with self._lock:
            now = self._clock()
            self._robots.setdefault(robot_id, _Robot(now)).hear(report, self._coded, now)

    def forget(self, robot_id: int) -> None:
        """A robot has registered: what was said under its ID before may be another one's, or of another battery."""
        with self._lock:
            self._robots.pop(robot_id, None)

    def of(self, robot_id: int) -> Report | None:
        """The newest report, with its `age` in s and `warnings` out of `WARNINGS`; None if there is none."""
        with self._lock:
            robot, now = self._robots.get(robot_id), self._clock()
            if robot is None:
                return None
            return {**robot.report, "age": now - robot.at, "warnings": robot.warnings(now)}

    def weak(self) -> frozenset[int]:
        """The robots whose voltage is too low."""
        with self._lock:
            now = self._clock()
            return frozenset(id_ for id_, robot in self._robots.items() if _WEAK.intersection(robot.warnings(now)))
