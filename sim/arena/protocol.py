r"""The link between a robot's hardware and the arena: ASCII lines, each ended by \n, over TCP; the robot is the client.

| robot -> arena | meaning |
|---|---|
| `robot <name>` | first line; name = 1 to 32 of A-Z a-z 0-9 _ - |
| `wheels <left> <right>` | cumulative signed half-steps since power-on |
| `beam 1`, `beam 0` | the IR emitter is on, off |

| arena -> robot | meaning |
|---|---|
| `light 1`, `light 0` | IR light falls on the sensor, does not; sent once after the hello and then when it changes |
| `error <text>` | why the arena closes the connection now |
"""

import re
from dataclasses import dataclass

MAX_LINE = 128  # bytes, the end of line included

_NAME = re.compile(rb"robot ([A-Za-z0-9_-]{1,32})")
_WHEELS = re.compile(rb"wheels (-?\d{1,15}) (-?\d{1,15})")
_BEAM = re.compile(rb"beam ([01])")


class LinkError(Exception):
    """A line that is not part of the protocol; the text tells the robot why."""


@dataclass(frozen=True)
class Wheels:
    """Cumulative half-steps since power-on."""

    left: int
    right: int


@dataclass(frozen=True)
class Beam:
    """The IR emitter's state."""

    on: bool


def parse_hello(line: bytes) -> str:
    """The robot's name from its first line (without the end of line); LinkError."""
    if match := _NAME.fullmatch(line):
        return match[1].decode()
    raise LinkError("first line must be: robot <name>, of 1 to 32 letters, digits, _ or -")


def parse_event(line: bytes) -> Wheels | Beam:
    """What a later line (without the end of line) tells; LinkError."""
    if match := _WHEELS.fullmatch(line):
        return Wheels(int(match[1]), int(match[2]))
    if match := _BEAM.fullmatch(line):
        return Beam(match[1] == b"1")
    raise LinkError("expected: wheels <left> <right>, or beam 0|1")


def light(lit: bool) -> bytes:
    """The line that tells a robot whether IR light falls on its sensor."""
    return b"light %d\n" % lit


def error(text: str) -> bytes:
    """The line that tells a robot why it is disconnected."""
    return f"error {text}\n".encode()
