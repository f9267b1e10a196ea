"""How much all pictures together may cost the network. Time is a monotonic clock in s. Pure."""

from collections import deque

BURST = 0.2  # s of the rate that may go out at once: a picture for all who look through one camera
DEBT = 1.0  # s of the rate after which spectators get pictures again, however much players and operators got before
SPAN = 2.0  # s over which a rate is measured


class Budget:
    """So many bytes a second. Everybody's count, and spectators wait for them."""

    def __init__(self, rate: float) -> None:
        """`rate` is in bytes/s."""
        self._rate = rate
        self._left = rate * BURST
        self._at = 0.0

    def spend(self, size: int, now: float) -> None:
        """A picture goes out."""
        self._refill(now)
        self._left = max(self._left - size, -self._rate * DEBT)

    def wait(self, now: float) -> float:
        """The s until a spectator may have a picture; 0: now."""
        self._refill(now)
        return 0.0 if self._left > 0 else 1e-3 - self._left / self._rate

    def _refill(self, now: float) -> None:
        self._left = min(self._left + (now - self._at) * self._rate, self._rate * BURST)
        self._at = now


class Meter:
    """An amount per second."""

    def __init__(self, now: float) -> None:
        self._total = 0.0
        self._marks = deque([(now, 0.0)])

    def add(self, amount: float) -> None:
        self._total += amount

    def rate(self, now: float) -> float:
        """Since the mark before `SPAN`, or since the beginning."""
        at, total = self._marks[0]
        return (self._total - total) / (now - at) if now > at else 0.0

    def mark(self, now: float) -> None:
        """To be called now and then."""
        self._marks.append((now, self._total))
        while len(self._marks) > 1 and self._marks[1][0] <= now - SPAN:
            self._marks.popleft()
