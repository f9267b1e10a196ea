"""What waits to be written to the serial line, paced at the line's speed.

Pacing keeps the kernel's buffer empty: what has been handed to the kernel cannot be taken back, so under a flood of
commands the robot would obey ever older ones.
"""

BITS_PER_BYTE = 10  # start, 8 data, stop


class TransmitQueue:
    """Protocol bytes in order and first; of commands only the newest of each topic."""

    def __init__(self, baudrate: int) -> None:
        self._byte_time = BITS_PER_BYTE / baudrate  # s
        self._protocol = bytearray()
        self._commands: dict[int, bytes] = {}
        self._line_free = 0.0

    def send(self, data: bytes) -> None:
        self._protocol += data

    def command(self, topic_id: int, frame: bytes) -> None:
        """Replaces a command for the same topic that has not been written yet."""
        self._commands[topic_id] = frame

    def take(self, now: float) -> bytes:
        """What is to be written now, empty if nothing or if the line is still busy."""
        if now < self._line_free:
            return b""
        if self._protocol:
            data = bytes(self._protocol)
            self._protocol.clear()
        elif self._commands:
            data = self._commands.pop(next(iter(self._commands)))
        else:
            return b""
        self._line_free = now + len(data) * self._byte_time
        return data

    @property
    def due(self) -> float | None:
        """When `take` has something, None if nothing waits."""
        return self._line_free if self._protocol or self._commands else None
