"""How many pictures a second a camera is asked for: as many as the fastest of its viewers can show. Time is a monotonic
clock in s. Pure.
"""

SHARES = (4, 2)  # a camera can be asked for this part of its full rate
# A viewer shows less than this of the lower rate before that is asked for. It then misses pictures at the lower rate,
# too, and so cannot be mistaken for one that has become faster.
ROOM = 0.6
PATIENCE = 5.0  # s that viewers are slow until the rate falls
# A viewer that has missed no picture for so long could show more: below ROOM it misses one in 0.6 s even of 5 a second.
EAGER = 0.8  # s


class Pace:
    """`rate` is in pictures/s, 0 is the camera's full one."""

    def __init__(self) -> None:
        self.rate = 0
        self._slow_since: float | None = None

    def restart(self) -> None:
        """The full rate at once: there is a new viewer, of whom nothing is known."""
        self.rate, self._slow_since = 0, None

    def judge(self, full: int, shown: float, complete: float, now: float) -> None:
        """The fastest viewer shows `shown` pictures/s, and somebody has missed none for `complete` s. `full` is the
        camera's full rate."""
        if complete >= EAGER:
            self.restart()
            return
        slower = next((full // share for share in SHARES if shown < ROOM * (full // share)), 0)
        if not slower or slower >= (self.rate or full):
            self._slow_since = None
        elif self._slow_since is None:
            self._slow_since = now
        elif now - self._slow_since >= PATIENCE:
            self.rate, self._slow_since = slower, None
