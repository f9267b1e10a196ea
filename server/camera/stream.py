"""The connection to a robot's camera: HTTP/1.0, as ustreamer answers it."""

import asyncio
import re
from collections.abc import Callable
from typing import NamedTuple

from laser_bot_battle.names import RELAY_HEADER
from server.camera.multipart import Part, Parts, StreamError, boundary_of
from tcpros import sockets

CONNECT = 3.0  # s until the camera must have answered
SILENCE = 3.0  # s without a complete picture; a camera that is away still sends one a second that says so
CHUNK = 64 * 2**10  # bytes that are read at once
MAX_ADDRESS = 300  # characters
STREAM = "/stream?extra_headers=1"  # of ustreamer, with the time of each picture

_ADDRESS = re.compile(
    r"http://(?P<host>[a-z0-9._-]{1,253}|\[[0-9a-f:.]{2,45}\]):(?P<port>[0-9]{1,5})(?P<target>(/[!-~]*)?)",
    re.ASCII | re.IGNORECASE,
)
_PATH = re.compile(r"(/[\w.-]*)*", re.ASCII)


class Address(NamedTuple):
    """Of a camera's stream."""

    host: str
    port: int
    target: str  # its path there, and a query perhaps

    @property
    def url(self) -> str:
        return f"http://{self.authority}{self.target}"

    @property
    def authority(self) -> str:
        """Host and port, as HTTP has them."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{host}:{self.port}"

    def at(self, rate: int) -> "Address":
        """With so many pictures/s, for a camera that has told its full rate; 0: with all."""
        return self._replace(target=f"{self.target}{'&' if '?' in self.target else '?'}rate={rate}") if rate else self


def address_of(value: object) -> Address:
    """The address that a robot's parameter holds. StreamError for anything else than http://host:port/path: whoever
    is in the ROS network can set it."""
    address = stream_of(value)
    if not address or not _PATH.fullmatch(address.target):
        raise StreamError("the robot tells a wrong address of its camera")
    return address._replace(target=address.target.rstrip("/") + STREAM)


def stream_of(value: object) -> Address | None:
    """The address http://host:port/target of a stream; None for anything else."""
    match = _ADDRESS.fullmatch(value) if isinstance(value, str) and len(value) <= MAX_ADDRESS else None
    if not match or not 0 < int(match["port"]) < 2**16:
        return None
    return Address(match["host"].strip("[]"), int(match["port"]), match["target"])


async def follow(address: Address, received: Callable[[Part], None]) -> None:
    """Call `received` with each part of the camera's stream; StreamError says why it ended."""
    try:
        async with asyncio.timeout(CONNECT):
            reader, writer = await asyncio.open_connection(address.host, address.port, limit=CHUNK)
    except (OSError, UnicodeError):  # the latter for what can be no name, such as a..b
        raise StreamError("the camera cannot be reached") from None
    writer.write(f"GET {address.target} HTTP/1.0\r\nHost: {address.authority}\r\n{RELAY_HEADER}: 1\r\n\r\n".encode())
    try:
        async with asyncio.timeout(CONNECT):
            head = await reader.readuntil(b"\r\n\r\n")
        parts = Parts(boundary_of(head))
        async with asyncio.timeout(SILENCE) as silence:
            while data := await reader.read(CHUNK):
                for part in parts.feed(data):
                    received(part)
                    silence.reschedule(asyncio.get_running_loop().time() + SILENCE)
    except asyncio.LimitOverrunError:
        raise StreamError("what answers there is no camera") from None
    except TimeoutError:
        raise StreamError(f"no picture came for {SILENCE:g} s") from None
    except (OSError, EOFError):
        raise StreamError("the connection to the camera is lost") from None
    finally:
        await sockets.end(writer)
    raise StreamError("the camera has ended the stream")
