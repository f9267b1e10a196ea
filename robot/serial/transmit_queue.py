"""What waits to be written to the serial line, paced at the line's speed.

Pacing keeps the kernel's buffer empty: what has been handed to the kernel cannot be taken back, so under a flood of
commands the robot would obey ever older ones.
"""

from collections import deque

BITS_PER_BYTE = 10  # start, 8 data, stop
MAX_ANSWERS = 512  # bytes that may wait, 90 ms at the usual speed; of longer frames one
PIECE = 1024  # bytes that are handed to the kernel at once
BROKEN_OFF = 0.03  # s of silence after which a device has given up half a frame; ros_lib does after 20 ms


class TransmitQueue:
    """Frames of the protocol in order, of commands only the newest of each topic; in turns while both wait, so that
    neither holds up the other for longer than one frame."""

    def __init__(self, baudrate: int) -> None:
        self.refused = 0  # frames of the protocol
        self._byte_time = BITS_PER_BYTE / baudrate  # s
        self._protocol: deque[bytes] = deque()
        self._protocol_size = 0
        self._long_waits = False  # a frame of more than MAX_ANSWERS, which the room does not count
        self._commands: dict[int, bytes] = {}
        self._begun = b""  # what is left of the frame that is being written
        self._commands_turn = True
        self._line_free = 0.0

    def send(self, frame: bytes) -> None:
        """A frame of the protocol. One for which there is no room is dropped and counted: whoever asks that often asks
        again."""
        if len(frame) > MAX_ANSWERS:
            has_room, self._long_waits = not self._long_waits, True
        else:
            has_room = self._protocol_size + len(frame) <= MAX_ANSWERS
            self._protocol_size += len(frame) if has_room else 0
        if has_room:
            self._protocol.append(frame)
        else:
            self.refused += 1

    def command(self, topic_id: int, frame: bytes) -> None:
        """Replaces a command for the same topic that has not been written yet."""
        self._commands[topic_id] = frame

    def break_off(self, now: float) -> float:
        """Give up the rest of a long frame that is being written: what is urgent need not wait for its end. Returns for
        how many s nothing is written now."""
        if not self._begun:
            return 0.0
        self._begun = b""
        self.refused += 1
        self._commands_turn = True
        self._line_free = max(now, self._line_free) + BROKEN_OFF
        return self._line_free - now

    def rest(self) -> bytes:
        """What is left of the frame that is being written, to be written at once."""
        rest, self._begun = self._begun, b""
        return rest

    def hold(self, until: float) -> None:
        """The line takes nothing before."""
        self._line_free = max(self._line_free, until)

    def take(self, now: float) -> bytes:
        """What is to be written now, empty if nothing or if the line is still busy: a frame, a long one in pieces."""
        if now < self._line_free or not self._waits():
            return b""
        frame = self._begun or self._next()
        piece, self._begun = frame[:PIECE], frame[PIECE:]
        self._line_free = now + len(piece) * self._byte_time
        return piece

    def _next(self) -> bytes:
        if self._commands and (self._commands_turn or not self._protocol):
            self._commands_turn = False
            return self._commands.pop(next(iter(self._commands)))
        self._commands_turn = True
        frame = self._protocol.popleft()
        if len(frame) > MAX_ANSWERS:
            self._long_waits = False
        else:
            self._protocol_size -= len(frame)
        return frame

    def _waits(self) -> bool:
        return bool(self._begun or self._protocol or self._commands)

    @property
    def due(self) -> float | None:
        """When `take` has something, None if nothing waits."""
        return self._line_free if self._waits() else None
