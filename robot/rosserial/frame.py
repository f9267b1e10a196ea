"""Frames of the rosserial protocol, version 2 ("groovy" and later).

    byte  0      1      2 3          4                   5 6         7 ...     last
          0xff   0xfe   length, LE   255-sum(2..3)%256   id, LE      payload   255-sum(5..last-1)%256

`length` counts the payload only.
"""

from dataclasses import dataclass

SYNC = b"\xff\xfe"
HEADER = 7  # bytes before the payload
MAX_PAYLOAD = 4096  # far above any device's buffer: a longer length is line noise that would swallow good frames
HALF_FRAME_TIMEOUT = 1.0  # s after which the rest of a frame is not waited for any longer


@dataclass(frozen=True)
class Frame:
    topic_id: int
    payload: bytes


def checksum(data: bytes | bytearray) -> int:
    return 255 - sum(data) % 256


def encode(topic_id: int, payload: bytes = b"") -> bytes:
    """The bytes of one frame; ValueError if the id or the length do not fit in 16 bits."""
    if not 0 <= topic_id <= 0xFFFF or len(payload) > 0xFFFF:
        raise ValueError(f"no frame for topic id {topic_id} with {len(payload)} bytes")
    length = len(payload).to_bytes(2, "little")
    body = topic_id.to_bytes(2, "little") + payload
    return SYNC + length + bytes([checksum(length)]) + body + bytes([checksum(body)])


class Decoder:
    """Finds the frames in a stream of bytes that may start anywhere, lose bytes and hold garbage.

    After a bad checksum only the first byte of the broken frame is dropped and the rest is searched again, so that a
    lost byte never costs more than its own frame.
    """

    def __init__(self) -> None:
        self.bad_frames = 0  # frames with a wrong checksum or an absurd length, or never completed
        self.garbage = 0  # bytes outside of frames
        self._buffer = bytearray()
        self._half_since: float | None = None

    def feed(self, data: bytes, now: float) -> list[Frame]:
        """The frames that `data` completes; `now` in s of any steady clock."""
        self._buffer += data
        return self._parse(now)

    def expire(self, now: float) -> list[Frame]:
        """Give up a frame whose rest does not come; returns the frames that it had seemed to contain."""
        if self._half_since is None or now - self._half_since < HALF_FRAME_TIMEOUT:
            return []
        self._drop_broken_frame()
        return self._parse(now)

    def _parse(self, now: float) -> list[Frame]:
        frames: list[Frame] = []
        half_since = None
        while self._skip_to_sync():
            whole = self._frame_size()
            if whole is None:
                self._drop_broken_frame()
            elif len(self._buffer) < whole:
                half_since = now if frames or self._half_since is None else self._half_since
                break
            elif checksum(self._buffer[5 : whole - 1]) != self._buffer[whole - 1]:
                self._drop_broken_frame()
            else:
                topic_id = int.from_bytes(self._buffer[5:HEADER], "little")
                frames.append(Frame(topic_id, bytes(self._buffer[HEADER : whole - 1])))
                del self._buffer[:whole]
        self._half_since = half_since
        return frames

    def _skip_to_sync(self) -> bool:
        """Drop what cannot start a frame; True if the start of one is left."""
        start = self._buffer.find(SYNC)
        if start < 0:
            start = len(self._buffer) - self._buffer.endswith(SYNC[:1])
        self.garbage += start
        del self._buffer[:start]
        return len(self._buffer) >= len(SYNC)

    def _frame_size(self) -> int | None:
        """Bytes of the frame at the start of the buffer as far as known, None if its header is broken."""
        if len(self._buffer) < 5:
            return HEADER + 1
        length = int.from_bytes(self._buffer[2:4], "little")
        if checksum(self._buffer[2:4]) != self._buffer[4] or length > MAX_PAYLOAD:
            return None
        return HEADER + length + 1

    def _drop_broken_frame(self) -> None:
        self.bad_frames += 1
        self._half_since = None
        del self._buffer[:1]
