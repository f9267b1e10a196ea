"""Pick-ups: what lies on the floor in a battle, and what it does for whoever drives over it. Pure."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from laser_bot_battle.floor import Zone

REPAIR, SHIELD, DOUBLE = KINDS = ("repair", "shield", "double damage")
REPAIRED = 30  # life, of 100
LASTS: Mapping[str, float] = {REPAIR: 0.0, SHIELD: 8.0, DOUBLE: 10.0}  # s


@dataclass
class PickUps:
    """Of one battle, by the names of their zones."""

    lying: dict[str, str] = field(default_factory=dict)  # kinds
    emptied: dict[str, float] = field(default_factory=dict)  # since when, monotonic s; else since the battle began
    laid: dict[str, int] = field(default_factory=dict)  # how many so far

    def lay(self, zone: str, kind: str) -> None:
        self.lying[zone] = kind
        self.laid[zone] = self.laid.get(zone, 0) + 1

    def take(self, zone: str, at: float) -> None:
        self.lying.pop(zone, None)
        self.emptied[zone] = at

    def due(self, zones: Iterable[Zone], every: float, began_at: float) -> Iterator[tuple[float, Zone, str]]:
        """When, where and which ones come, if each place is filled so many s after it was emptied. What lies at a place
        changes each time, and is not the same everywhere."""
        for number, zone in enumerate(zones):
            if zone.name not in self.lying:
                kind = KINDS[(number + self.laid.get(zone.name, 0)) % len(KINDS)]
                yield self.emptied.get(zone.name, began_at) + every, zone, kind

    def leave_out(self, seconds: float) -> None:
        """A pause is no time."""
        self.emptied = {zone: at + seconds for zone, at in self.emptied.items()}

    def save(self, now: float) -> dict[str, Any]:
        """In JSON's types; times in s before `now`."""
        emptied = {zone: at - now for zone, at in self.emptied.items()}
        return {"lying": dict(self.lying), "emptied": emptied, "laid": dict(self.laid)}

    @classmethod
    def restore(cls, saved: Mapping[str, Any], then: float) -> "PickUps":
        """What was saved at the time `then`. KeyError, TypeError or ValueError for anything else."""
        return cls(
            {str(zone): str(kind) for zone, kind in saved["lying"].items() if kind in KINDS},
            {str(zone): then + float(at) for zone, at in saved["emptied"].items()},
            {str(zone): int(number) for zone, number in saved["laid"].items()},
        )
