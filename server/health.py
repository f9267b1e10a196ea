"""How the robots are, as they say themselves once a second: the newest of each. Pure, but for a lock."""

import threading
import time
from collections.abc import Callable
from typing import Any

FRESH = 5.0  # s that a report holds
LOW_SUPPLY = 4600  # mV of the Arduino: at 4500 it can no longer be relied on at its clock

WARNINGS = ("silent", "low_supply", "under_voltage", "deaf")
_WEAK = {"low_supply", "under_voltage"}

Report = dict[str, Any]  # a laser_bot_battle/Health in JSON's types


class RobotsHealth:
    """For any thread."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._reports: dict[int, tuple[float, Report]] = {}

    def report(self, robot_id: int, report: Report) -> None:
        with self._lock:
            self._reports[robot_id] = (self._clock(), report)

    def forget(self, robot_id: int) -> None:
        """The robot has gone."""
        with self._lock:
            self._reports.pop(robot_id, None)

    def of(self, robot_id: int) -> Report | None:
        """The newest report, with its `age` in s and `warnings` out of `WARNINGS`; None if there is none."""
        with self._lock:
            found = self._reports.get(robot_id)
        if found is None:
            return None
        at, report = found
        age = self._clock() - at
        return {**report, "age": age, "warnings": ["silent"] if age > FRESH else _warnings(report)}

    def weak(self) -> frozenset[int]:
        """The robots whose voltage is too low."""
        with self._lock:
            now, reports = self._clock(), list(self._reports.items())
        fresh = ((robot_id, report) for robot_id, (at, report) in reports if now - at <= FRESH)
        return frozenset(robot_id for robot_id, report in fresh if _WEAK.intersection(_warnings(report)))


def _warnings(report: Report) -> list[str]:
    board = report["board"]
    signs = {
        "low_supply": board is not None and 0 < board["supply"] < LOW_SUPPLY,
        "under_voltage": report["under_voltage"],
        "deaf": board is not None and board["deaf"],
    }
    return [name for name, is_so in signs.items() if is_so]
