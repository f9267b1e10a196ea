"""What waits to be written to the serial line, paced at the line's speed.

Pacing keeps the kernel's buffer empty: what has been handed to the kernel cannot be taken back, so under a flood of
commands the robot would obey ever older ones.
"""

from collections import deque

BITS_PER_BYTE = 10  # start, 8 data, stop
MAX_ANSWERS = 512  # bytes that may wait, 90 ms at the usual speed


class TransmitQueue:
    """Frames of the protocol in order, of commands only the newest of each topic; in turns while both wait, so that
    neither holds up the other for longer than one frame."""

    def __init__(self, baudrate: int) -> None:
        self.refused = 0  # frames of the protocol
        self._byte_time = BITS_PER_BYTE / baudrate  # s
        self._protocol: deque[bytes] = deque()
        self._protocol_size = 0
        self._commands: dict[int, bytes] = {}
        self._commands_turn = True
        self._line_free = 0.0

    def send(self, frame: bytes) -> None:
        """A frame of the protocol. One for which there is no room is dropped and counted: whoever asks that often asks
        again."""
        if self._protocol and self._protocol_size + len(frame) > MAX_ANSWERS:
            self.refused += 1
            return
        self._protocol.append(frame)
        self._protocol_size += len(frame)

    def command(self, topic_id: int, frame: bytes) -> None:
        """Replaces a command for the same topic that has not been written yet."""
        self._commands[topic_id] = frame

    def take(self, now: float) -> bytes:
        """What is to be written now, empty if nothing or if the line is still busy."""
        if now < self._line_free or not (self._protocol or self._commands):
            return b""
        if self._commands and (self._commands_turn or not self._protocol):
            frame = self._commands.pop(next(iter(self._commands)))
            self._commands_turn = False
        else:
            frame = self._protocol.popleft()
            self._protocol_size -= len(frame)
            self._commands_turn = True
        self._line_free = now + len(frame) * self._byte_time
        return frame

    @property
    def due(self) -> float | None:
        """When `take` has something, None if nothing waits."""
        return self._line_free if self._protocol or self._commands else None
