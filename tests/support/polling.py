"""Waiting in tests: poll with a deadline, never sleep a fixed time."""

import os
import time
from collections.abc import Callable
from typing import Literal, TypeVar

T = TypeVar("T")


def patience() -> float:
    """How many times longer everything may take now than on a quiet machine."""
    return max(1.0, os.getloadavg()[0] / len(os.sched_getaffinity(0)))


def until(condition: Callable[..., T | Literal[False] | None], seconds: float = 20.0, what: str = "") -> T:
    """Call `condition` until it returns something true and return that.

    AssertionError after `seconds` of a quiet machine.
    """
    seconds *= patience()
    deadline = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError(f"not within {seconds:.1f} s: {what or condition}; last value {value!r}")
        time.sleep(0.01)
