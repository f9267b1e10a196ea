r"""The link between a robot's hardware and the arena: ASCII lines, each ended by \n, over TCP; the robot is the client.

| robot -> arena | meaning |
|---|---|
| `robot <name>` | first line; name = 1 to 32 of A-Z a-z 0-9 _ - |
| `wheels <left> <right>` | cumulative signed half-steps since power-on |
| `beam 1`, `beam 0` | the IR emitter gives plain light, does not |
| `carrier 1 <cycle>`, `carrier 0 <cycle>` | it gives light of 38 kHz from then on, does not; or still does, does not |

| arena -> robot | meaning |
|---|---|
| `light 1`, `light 0` | plain light falls on it, does not; sent once after the hello and then when it changes |
| `lamp 1` | a lamp falls on it: plain light that comes and goes 100 times a second |
| `carrier <source> 1 <cycle>`, `carrier <source> 0 <cycle>` | light of 38 kHz falls on it, does not; likewise |
| `error <text>` | why the arena closes the connection now |

Cycles are of the source's own clock, 16 a microsecond. Sources are numbers from 0 to 15. Whoever sees the first edge of
one after a pause sees the others as much later as they were in its time. During a packet a robot tells each ms how its
carrier is, and whoever sees it waits for that: so a packet is seen as it was, however late the robots' programs are.
"""

import re
from dataclasses import dataclass

MAX_LINE = 128  # bytes, the end of line included

_NAME = re.compile(rb"robot ([A-Za-z0-9_-]{1,32})")
_WHEELS = re.compile(rb"wheels (-?\d{1,15}) (-?\d{1,15})")
_BEAM = re.compile(rb"beam ([01])")
_CARRIER = re.compile(rb"carrier ([01]) (\d{1,18})")


class LinkError(Exception):
    """A line that is not part of the protocol; the text tells the robot why."""


@dataclass(frozen=True)
class Wheels:
    """Cumulative half-steps since power-on."""

    left: int
    right: int


@dataclass(frozen=True)
class Beam:
    """The IR emitter's plain light."""

    on: bool


@dataclass(frozen=True)
class CarrierEdge:
    """The IR emitter's light of 38 kHz starts or ends at `cycle` of the robot's time, or is still on or off."""

    on: bool
    cycle: int


def parse_hello(line: bytes) -> str:
    """The robot's name from its first line (without the end of line); LinkError."""
    if match := _NAME.fullmatch(line):
        return match[1].decode()
    raise LinkError("first line must be: robot <name>, of 1 to 32 letters, digits, _ or -")


def parse_event(line: bytes) -> Wheels | Beam | CarrierEdge:
    """What a later line (without the end of line) tells; LinkError."""
    if match := _WHEELS.fullmatch(line):
        return Wheels(int(match[1]), int(match[2]))
    if match := _BEAM.fullmatch(line):
        return Beam(match[1] == b"1")
    if match := _CARRIER.fullmatch(line):
        return CarrierEdge(match[1] == b"1", int(match[2]))
    raise LinkError("expected: wheels <left> <right>, beam 0|1, or carrier 0|1 <cycle>")


def light(lit: bool) -> bytes:
    """The line that tells a robot whether plain light falls on its receiver."""
    return b"light %d\n" % lit


def lamp() -> bytes:
    """The line that tells a robot that a lamp shines."""
    return b"lamp 1\n"


def carrier(source: int, on: bool, cycle: int) -> bytes:
    """The line that tells a robot what light of 38 kHz falls on it at `cycle` of the source's time."""
    return b"carrier %d %d %d\n" % (source, on, cycle)


def error(text: str) -> bytes:
    """The line that tells a robot why it is disconnected."""
    return f"error {text}\n".encode()
