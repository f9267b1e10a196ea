"""The WebSocket's frames (RFC 6455, 5): bytes from a client become messages, messages become bytes. Pure."""

from typing import NamedTuple

from websockets.exceptions import ProtocolError
from websockets.frames import Close

try:
    from websockets.speedups import apply_mask
except ImportError:  # built without its C part: slower, and the same
    from websockets.utils import apply_mask

CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA
FINAL = 0x80  # first byte: the last frame of its message
MASKED = 0x80  # second byte
MAX_CONTROL = 125  # bytes in a control frame
# Every part of a message costs time, however short it is. No client needs as many.
MAX_PARTS = 1000


class Ping(NamedTuple):
    data: bytes


class Pong(NamedTuple):
    data: bytes


Message = str | bytes | Ping | Pong | Close


class FrameError(Exception):
    """The client breaks the protocol or a limit: the connection is to be closed with this code (RFC 6455, 7.4.1)."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(reason)
        self.code, self.reason = code, reason


class Frames:
    """What one client sends, in pieces of any size."""

    __slots__ = ("_at", "_buffer", "_count", "_kind", "_parts", "max_message")

    def __init__(self, max_message: int) -> None:
        """`max_message` is in bytes, and may be changed at any time."""
        self.max_message = max_message
        self._buffer = bytearray()
        self._at = 0  # what is before it has been taken
        self._parts = bytearray()  # of a message that is not complete
        self._kind = CONTINUATION  # of that message, or of none
        self._count = 0  # of its parts

    @property
    def pending(self) -> int:
        """Bytes that have not been taken."""
        return len(self._buffer) - self._at

    def feed(self, data: bytes | memoryview) -> None:
        self._buffer += data

    def take(self) -> Message | None:
        """The next message or control frame, None when it has not come yet. After a FrameError there is none."""
        while (frame := self._next()) is not None:
            head, payload = frame
            if head == FINAL | TEXT:
                return _decoded(payload)
            if (message := self._put(head, payload)) is not None:
                return message
        del self._buffer[: self._at]
        self._at = 0
        return None

    def _next(self) -> tuple[int, bytes] | None:
        """First byte and payload of the next frame, None when it is not complete."""
        buffer, at = self._buffer, self._at
        come = len(buffer) - at
        if come < 2:
            return None
        head, length = buffer[at], buffer[at + 1] - MASKED
        if length < 0:
            raise FrameError(1002, "a client masks its frames")
        begin = at + 6
        if length > MAX_CONTROL:
            size = 2 if length == 126 else 8
            if come < 2 + size:
                return None
            length = int.from_bytes(buffer[at + 2 : at + 2 + size], "big")
            begin += size
        if head != FINAL | TEXT or self._kind or length > self.max_message:
            self._check(head, length)
        end = begin + length
        if len(buffer) < end:
            return None
        self._at = end
        return head, apply_mask(buffer[begin:end], buffer[begin - 4 : begin])  # type: ignore[arg-type]  # takes buffers

    def _check(self, head: int, length: int) -> None:
        """Before the payload comes: nobody shall fill the memory with what will be refused."""
        opcode = head & ~FINAL
        if opcode in (CLOSE, PING, PONG):
            if length > MAX_CONTROL or not head & FINAL:
                raise FrameError(1002, "a control frame is one short frame")
            return
        if opcode not in (CONTINUATION, TEXT, BINARY):
            raise FrameError(1002, "unknown kind of frame")
        if (opcode == CONTINUATION) != bool(self._kind):
            raise FrameError(1002, "the parts of a message come one after the other")
        if len(self._parts) + length > self.max_message:
            raise FrameError(1009, f"a message has at most {self.max_message} bytes here")
        if self._count >= MAX_PARTS:
            raise FrameError(1008, f"a message has at most {MAX_PARTS} parts here")

    def _put(self, head: int, payload: bytes) -> Message | None:
        """A frame that `_check` has seen: the message that it completes."""
        opcode = head & ~FINAL
        if opcode == PING:
            return Ping(payload)
        if opcode == PONG:
            return Pong(payload)
        if opcode == CLOSE:
            return _close(payload)
        self._kind = self._kind or opcode
        self._parts += payload
        self._count += 1
        if not head & FINAL:
            return None
        kind, data = self._kind, bytes(self._parts)
        self._kind, self._parts, self._count = CONTINUATION, bytearray(), 0
        return _decoded(data) if kind == TEXT else data


class Framed(bytes):
    """One message or several, in their frames already."""


def frame(data: str | bytes) -> bytes:
    """A message as a server sends it: in one frame, the same for whoever gets it."""
    if isinstance(data, Framed):
        return data
    return _framed(TEXT, data.encode()) if isinstance(data, str) else _framed(BINARY, data)


def ping_frame() -> bytes:
    return _framed(PING, b"")


def pong_frame(data: bytes) -> bytes:
    return _framed(PONG, data)


def close_frame(code: int, reason: str) -> bytes:
    """What is too long of the reason is cut off."""
    text = reason.encode()[: MAX_CONTROL - 2].decode(errors="ignore")
    return _framed(CLOSE, Close(code, text).serialize())


def _framed(opcode: int, payload: bytes) -> bytes:
    length = len(payload)
    if length < 126:
        return bytes((FINAL | opcode, length)) + payload
    if length < 2**16:
        return bytes((FINAL | opcode, 126)) + length.to_bytes(2, "big") + payload
    return bytes((FINAL | opcode, 127)) + length.to_bytes(8, "big") + payload


def _decoded(payload: bytes) -> str:
    try:
        return payload.decode()
    except UnicodeDecodeError:
        raise FrameError(1007, "a text is not UTF-8") from None


def _close(payload: bytes) -> Close:
    try:
        return Close.parse(payload)
    except UnicodeDecodeError:
        raise FrameError(1007, "the reason for closing is not UTF-8") from None
    except ProtocolError as error:
        raise FrameError(1002, str(error)) from None
