"""What the arena tells the process that paints, and how: JSON in frames with their length before them. Pure."""

import json
import struct
from dataclasses import asdict, dataclass
from typing import BinaryIO

from laser_bot_battle.geometry import Point, Wall
from sim.arena.ambient import Ambient

LENGTH = struct.Struct(">I")  # bytes of a frame that follow
MAX_FRAME = 2**20  # bytes


@dataclass(frozen=True)
class Room:
    """What does not change: the floor (m), the light that is no robot's, and whether pictures carry a time code."""

    width: float
    height: float
    walls: tuple[Wall, ...]
    ambient: Ambient
    timecode: bool = False

    @classmethod
    def decode(cls, frame: bytes) -> "Room":
        told = json.loads(frame)
        walls = tuple((x1, y1, x2, y2) for x1, y1, x2, y2 in told["walls"])
        return cls(told["width"], told["height"], walls, Ambient(**told["ambient"]), told["timecode"])

    def encode(self) -> bytes:
        return json.dumps(asdict(self)).encode()


@dataclass(frozen=True)
class Body:
    """A robot as eyes see it. `reach` is how far its light would go (m from the emitter), if it shines."""

    name: str
    id: int | None
    x: float
    y: float
    heading: float
    beam: bool = False
    lit: bool = False
    reach: float = 0.0

    @property
    def point(self) -> Point:
        return self.x, self.y

    @property
    def number(self) -> int:
        """What gives its colour, as on the arena's page: its ID; without one, its name does."""
        return self.id if self.id is not None else sum(map(ord, self.name))


@dataclass(frozen=True)
class Scene:
    """A moment: everything on the floor, and through whose eyes (a robot's name) it is to be painted.

    `time` is of the arena's clock, `taken` is Unix time; both in s.
    """

    eye: str
    time: float
    taken: float
    robots: tuple[Body, ...]

    @classmethod
    def decode(cls, frame: bytes) -> "Scene":
        told = json.loads(frame)
        return cls(told["eye"], told["time"], told["taken"], tuple(Body(**body) for body in told["robots"]))

    def encode(self) -> bytes:
        return json.dumps(asdict(self)).encode()


def frame_of(content: bytes) -> bytes:
    """`content` with its length."""
    return LENGTH.pack(len(content)) + content


def read_frame(stream: BinaryIO) -> bytes | None:
    """The next frame's content, None at the end of the stream."""
    head = stream.read(LENGTH.size)
    if len(head) < LENGTH.size:
        return None
    (length,) = LENGTH.unpack(head)
    content = stream.read(length)
    return content if len(content) == length else None
