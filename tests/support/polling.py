"""Waiting in tests: poll with a deadline, never sleep a fixed time."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Literal, TypeVar

T = TypeVar("T")

POLL = 0.01  # s
LONGEST_TURN = 0.5  # s that one turn of a loop counts at most: for longer, something has held up this very process
# Deadlines are for a quiet machine of the kind that the tests were written on; ci/test says how many times slower this
# one is.
SLOWNESS = max(1.0, float(os.environ.get("TESTS_SLOWNESS", "1")))
LATEST = 60.0 * SLOWNESS  # s; what has not come by then, and cannot be polled for, will not come any more
AGAIN = 5.0  # s until an attempt is given up that is repeated anyway: a dead server must not hold up the next one


class Patience:
    """Counts the seconds that a quiet machine would have needed, so that a busy one is given more time.

    It looks at how many programs want a processor at this moment. The load average tells of a spike when it is over.
    """

    def __init__(self, seconds: float) -> None:
        """`seconds`: how long it lasts on a quiet machine."""
        self._left = seconds * SLOWNESS
        self._looked = time.monotonic()

    @property
    def is_over(self) -> bool:
        now = time.monotonic()
        self._left -= min(now - self._looked, LONGEST_TURN) / competitors()
        self._looked = now
        return self._left < 0


def competitors() -> float:
    """Programs that want a processor now, for each processor there is; at least 1."""
    wanting = int(Path("/proc/loadavg").read_text().split()[3].partition("/")[0])
    return max(1.0, wanting / len(os.sched_getaffinity(0)))


def until(condition: Callable[..., T | Literal[False] | None], seconds: float = 20.0, what: str = "") -> T:
    """Call `condition` until it returns something true and return that.

    AssertionError after `seconds` of a quiet machine.
    """
    patience = Patience(seconds)
    while True:
        value = condition()
        if value:
            return value
        if patience.is_over:
            raise AssertionError(f"not within {seconds:.1f} s: {what or condition}; last value {value!r}")
        time.sleep(POLL)
