"""A picture on its way: out of a part of the camera's stream, into a message for viewers (docs/protocol-camera.md)."""

import math
import re
import struct
from typing import NamedTuple

from laser_bot_battle.names import RATE_HEADER
from server.camera.clock import ClockOffset
from server.camera.multipart import Part, StreamError

_HEADER = struct.Struct("<B3xIdd")  # robot, number, taken, sent
_RATE = re.compile(r"[1-9][0-9]{0,2}")
_BEGIN, _END = b"\xff\xd8\xff", b"\xff\xd9"


class Picture(NamedTuple):
    robot: int
    number: int
    taken: float  # Unix time in s, by this machine's clock
    online: bool  # false: the camera is away, and the picture only says so
    jpeg: bytes

    def message(self, sent: float) -> bytes:
        """For a viewer, at Unix time `sent` in s."""
        return _HEADER.pack(self.robot, self.number & 0xFFFFFFFF, self.taken, sent) + self.jpeg


def dated(part: Part, now: float) -> Part:
    """With a time, at Unix time `now` in s: a camera that tells none took it, as far as anybody knows, when it came."""
    return part if "x-timestamp" in part.headers else Part({**part.headers, "x-timestamp": f"{now:.6f}"}, part.body)


def full_rate_of(part: Part) -> int:
    """The pictures/s that the camera sends unless asked for fewer; 0 of a camera that cannot be asked."""
    told = part.headers.get(RATE_HEADER.lower(), "")
    return int(told) if _RATE.fullmatch(told) else 0


def picture_of(part: Part, robot: int, number: int, offset: ClockOffset, received: float) -> Picture:
    """The picture in `part`, which was here at Unix time `received` in s. StreamError if it is none."""
    jpeg = part.body.rstrip(b"\0")  # some cameras fill up their buffer
    if not jpeg.startswith(_BEGIN) or not jpeg.endswith(_END):
        raise StreamError("the camera sends something else than pictures")
    stamp = _seconds(part.headers.get("x-timestamp", ""))
    if stamp is None:
        raise StreamError("the camera does not tell when a picture was taken")
    online = part.headers.get("x-ustreamer-online", "true").lower() != "false"
    # ustreamer's time stamp is that of sending, and its latency all that came before. While the camera is away, the
    # latency is the time since the robot was switched on.
    latency = (online and _seconds(part.headers.get("x-ustreamer-latency", ""))) or 0.0
    taken = stamp + offset.sample(stamp, received) - latency
    return Picture(robot, number, taken, online, jpeg)


def _seconds(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and 0 <= value < 1e11 else None
