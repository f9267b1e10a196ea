"""The dead-man rule: a robot whose commands stop coming is told to stop."""

SILENCE = 0.3  # s after a command until neutral is sent


class DeadMan:
    """Watches the commands of one topic. Times are s of one steady clock."""

    def __init__(self, neutral: bytes) -> None:
        self.neutral = neutral
        self._deadline: float | None = None

    def command(self, payload: bytes, now: float) -> None:
        """A command has come."""
        self._deadline = None if payload == self.neutral else now + SILENCE

    @property
    def deadline(self) -> float | None:
        """When neutral is due if nothing else comes; None while the robot is neutral."""
        return self._deadline

    def expired(self, now: float) -> bool:
        """True once when neutral is due."""
        if self._deadline is None or now < self._deadline:
            return False
        self._deadline = None
        return True
