"""How long to wait before the next attempt: next to nothing at first, longer only while it fails again and again."""

FIRST = 0.2  # s
STEADY = 10.0  # s; what has worked for so long has not failed at its start


class Backoff:
    """Twice as long after each failure, `most` s in the end."""

    def __init__(self, most: float) -> None:
        self._most = most
        self._next = min(FIRST, most)

    def failed(self) -> float:
        """For how many s to wait after one more failure."""
        wait, self._next = self._next, min(2 * self._next, self._most)
        return wait

    def worked(self) -> None:
        """The attempt has held for a while: the next failure is the first."""
        self._next = min(FIRST, self._most)
