"""What the arena tells the process that paints the floor from above. Pure."""

import json
from dataclasses import asdict, dataclass

from laser_bot_battle.floor import Floor
from sim.arena.overhead.conditions import Conditions


@dataclass(frozen=True)
class Room:
    """What does not change."""

    floor: Floor
    conditions: Conditions

    @classmethod
    def decode(cls, frame: bytes) -> "Room":
        told = json.loads(frame)
        floor = told["floor"]
        walls = tuple((x1, y1, x2, y2) for x1, y1, x2, y2 in floor["walls"])
        return cls(Floor(floor["width"], floor["height"], walls, ()), Conditions(**told["conditions"]))

    def encode(self) -> bytes:
        return json.dumps(asdict(self)).encode()
