"""Budgets of those who may ask as often as they like: so many at once, then one in a while."""

import threading
from collections.abc import Hashable

_ROUNDING = 1e-6  # s


class TokenBuckets:
    """`burst` at once for each key, such as an address, and then one per `period` s. Thread-safe.

    The time is an argument, of a monotonic clock in s. Of more than `keys` keys, the one that was seen least recently
    is forgotten.
    """

    def __init__(self, burst: int, period: float, keys: int = 1000) -> None:
        self._allowance = (burst - 1) * period
        self._period = period
        self._keys = keys
        self._full_at: dict[Hashable, float] = {}  # when all tokens are back; the last seen key is last
        self._lock = threading.Lock()

    def take(self, key: Hashable, now: float) -> float:
        """Take a token and return 0.0, or take none and return the s until there is one."""
        with self._lock:
            full_at = max(self._full_at.pop(key, now), now)
            wait = full_at - now - self._allowance
            taken = wait <= _ROUNDING
            self._full_at[key] = full_at + self._period if taken else full_at
            if len(self._full_at) > self._keys:
                del self._full_at[next(iter(self._full_at))]
            return 0.0 if taken else wait

    def charge(self, key: Hashable, tokens: int, now: float) -> None:
        """Take tokens whether they are there or not: what is owed has to come back before the next one is given."""
        with self._lock:
            self._full_at[key] = max(self._full_at.pop(key, now), now) + tokens * self._period
