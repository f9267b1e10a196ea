"""A sketch may write a log line in each turn of its loop: some are passed on, the others are counted."""

from collections.abc import Iterable

from laser_bot_battle.token_bucket import TokenBuckets
from robot.rosserial.events import DeviceLog, Event

BURST = 20  # log lines at once, then
PERIOD = 0.2  # s for each further one
COUNTED_FOR = 1.0  # s from the first line that is left out to the line that says how many were
_WARNING = 2  # level


class LogBudget:
    """Of one device. Time is a steady clock in s."""

    def __init__(self) -> None:
        self._lines = TokenBuckets(BURST, PERIOD)
        self._left_out = 0
        self._counted_since = 0.0

    def within(self, events: Iterable[Event], now: float) -> list[Event]:
        """The events without log lines that are too many; to be called at least twice a second, also with none."""
        passed = [event for event in events if not isinstance(event, DeviceLog) or self._takes(now)]
        if self._left_out and now - self._counted_since >= COUNTED_FOR:
            passed.append(DeviceLog(_WARNING, f"{self._left_out:,} further log lines of the sketch were left out"))
            self._left_out = 0
        return passed

    def _takes(self, now: float) -> bool:
        if not self._lines.take("", now):
            return True
        if not self._left_out:
            self._counted_since = now
        self._left_out += 1
        return False
