"""Frames of the rosserial protocol, version 2 ("groovy" and later).

    byte  0      1      2 3          4                   5 6         7 ...     last
          0xff   0xfe   length, LE   255-sum(2..3)%256   id, LE      payload   255-sum(5..last-1)%256

`length` counts the payload only.
"""

from collections.abc import Iterator
from dataclasses import dataclass

SYNC = b"\xff\xfe"
HEADER = 7  # bytes before the payload
OVERHEAD = HEADER + 1
MAX_PAYLOAD = 0xFFFF  # what the length's 16 bits can say
# Longer than the buffers of most devices. One that has not said that its own are larger does not send more, and in
# line noise a longer length would swallow good frames.
USUAL_PAYLOAD = 4096
HALF_FRAME_TIMEOUT = 1.0  # s beyond its time on the line after which the rest of a frame is not waited for any longer


@dataclass(frozen=True)
class Frame:
    topic_id: int
    payload: bytes


def checksum(data: bytes | bytearray) -> int:
    return 255 - sum(data) % 256


def encode(topic_id: int, payload: bytes = b"") -> bytes:
    """The bytes of one frame; ValueError if the id or the length do not fit in 16 bits."""
    if not 0 <= topic_id <= 0xFFFF or len(payload) > MAX_PAYLOAD:
        raise ValueError(f"no frame for topic id {topic_id} with {len(payload)} bytes")
    length = len(payload).to_bytes(2, "little")
    body = topic_id.to_bytes(2, "little") + payload
    return SYNC + length + bytes([checksum(length)]) + body + bytes([checksum(body)])


class Decoder:
    """Finds the frames in a stream of bytes that may start anywhere, lose bytes and hold garbage.

    After a bad checksum only the first byte of the broken frame is dropped and the rest is searched again, so that a
    lost byte never costs more than its own frame.
    """

    def __init__(self, byte_time: float = 0.0) -> None:
        """`byte_time`: s that a byte takes on the line."""
        self.longest = USUAL_PAYLOAD  # bytes of payload; a frame with more is passed over
        self.bad_frames = 0  # frames with a wrong checksum or too long, or never completed
        self.too_long = 0  # of these, frames with a correct header that says more than `longest`
        self.last_too_long = 0  # bytes of payload of the last one
        self.garbage = 0  # bytes outside of frames
        self._byte_time = byte_time
        self._buffer = bytearray()
        self._half_since: float | None = None
        self._passing_over = 0  # bytes of a frame that is too long, still to come

    def feed(self, data: bytes, now: float) -> list[Frame]:
        """The frames that `data` completes; `now` in s of any steady clock."""
        return list(self.frames(data, now))

    def frames(self, data: bytes, now: float) -> Iterator[Frame]:
        """The same one by one, so that a frame may say that those behind it are longer. To be read to its end."""
        self._buffer += data
        return self._parse(now)

    def expire(self, now: float) -> list[Frame]:
        """Give up a frame whose rest does not come; returns the frames that it had seemed to contain."""
        if self._half_since is None:
            return []
        on_the_line = (OVERHEAD + (self._length() or 0)) * self._byte_time
        if now - self._half_since < HALF_FRAME_TIMEOUT + on_the_line:
            return []
        self._half_since = None
        self._drop_broken_frame()
        return list(self._parse(now))

    def _parse(self, now: float) -> Iterator[Frame]:
        half_since, since = None, self._half_since
        while self._skip_to_sync():
            length = self._length()
            whole = OVERHEAD + (length or 0)
            if length is None:
                self._drop_broken_frame()
            elif length > self.longest:
                self._pass_over(length)
            elif len(self._buffer) < whole:
                half_since = now if since is None else since
                break
            elif checksum(self._buffer[5 : whole - 1]) != self._buffer[whole - 1]:
                self._drop_broken_frame()
            else:
                topic_id = int.from_bytes(self._buffer[5:HEADER], "little")
                frame = Frame(topic_id, bytes(self._buffer[HEADER : whole - 1]))
                self._take(whole)
                yield frame
            since = None
        self._half_since = half_since

    def _skip_to_sync(self) -> bool:
        """Drop what cannot start a frame; True if the start of one is left."""
        start = self._buffer.find(SYNC)
        if start < 0:
            start = len(self._buffer) - self._buffer.endswith(SYNC[:1])
        self.garbage += self._take(start)
        return len(self._buffer) >= len(SYNC)

    def _length(self) -> int | None:
        """Bytes of payload of the frame at the start of the buffer, 0 while that is not known, None if its header is
        broken."""
        if len(self._buffer) < 5:
            return 0
        if checksum(self._buffer[2:4]) != self._buffer[4]:
            return None
        return int.from_bytes(self._buffer[2:4], "little")

    def _pass_over(self, length: int) -> None:
        if not self._passing_over:
            self.too_long += 1
            self.last_too_long = length
        self._drop_broken_frame()
        self._passing_over = self._passing_over or OVERHEAD + length - 1

    def _drop_broken_frame(self) -> None:
        """Its first byte, that is: what follows may be a good one."""
        if not self._passing_over:
            self.bad_frames += 1
        self._take(1)

    def _take(self, count: int) -> int:
        """Remove so many bytes; returns how many of them are not of a frame that is passed over."""
        del self._buffer[:count]
        known = min(count, self._passing_over)
        self._passing_over -= known
        return count - known
