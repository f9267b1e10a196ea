"""How quickly the turns of a busy event loop may follow each other."""

# Waking up costs more than a message. What comes within this time is handled by one waking.
TURN = 0.0015  # s
# With fewer messages than this a second, the rest would cost more than the wakings that it saves, and nothing waits.
BUSY_RATE = 800.0  # 1/s
WINDOW = 0.05  # s over which messages are counted


class Pace:
    """Under load a turn begins at least `TURN` after the last."""

    def __init__(self) -> None:
        self.busy = False
        self._since = 0.0
        self._count = 0

    def rest(self, began: float, now: float, messages: int) -> float:
        """How long to wait, in s, after the turn that began at `began`, handled so many messages, and has ended now."""
        self._count += messages
        passed = began - self._since
        if passed >= WINDOW:
            self.busy = self._count > BUSY_RATE * passed
            self._since, self._count = began, 0
        return max(0.0, began + TURN - now) if self.busy else 0.0
