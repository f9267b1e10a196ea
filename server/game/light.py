"""The light by which robots shoot at each other, as far as the referee must know it (docs/protocol-light.md)."""

from dataclasses import dataclass, field

COOLDOWN = 0.5  # s from the start of one shot to the next, at least
PULSE = 0.5  # s that the plain light of a shot lasts
PACKET = 0.03  # s that a coded shot lasts
# s that a report of a hit may take longer than the news of its shot: the way over radio, robot and serial line
DELAY = 0.3
_EARLY = 0.1  # s that the network may take longer for one shot's news than for the next one's

# what MilesTag II's codes 0 to 15 take
DAMAGES = (1, 2, 4, 5, 7, 10, 15, 17, 20, 25, 30, 35, 40, 50, 75, 100)


def damage_code(damage: int) -> int:
    """The code whose damage is nearest to `damage`; of two, the smaller."""
    return min(range(len(DAMAGES)), key=lambda code: abs(DAMAGES[code] - damage))


@dataclass(slots=True)
class Shot:
    """One that was fired by a living fighter."""

    at: float
    by: str  # the fighter's name
    team: int
    met: set[int] = field(default_factory=set)  # robots: each is hit once at most

    def is_under_way(self, now: float, lasts: float) -> bool:
        """Whether its light, which lasts so long, may be what a robot reports now."""
        return now - self.at <= lasts + DELAY


class Emitter:
    """The light of one robot: what it has fired of late."""

    def __init__(self) -> None:
        self.shots: list[Shot] = []
        self._next = 0.0

    def fire(self, shot: Shot) -> bool:
        """Whether the robot can have fired it: not sooner than the cooldown allows."""
        if shot.at < self._next - _EARLY:
            return False
        self._next = max(self._next, shot.at) + COOLDOWN
        self.shots = [one for one in self.shots if one.is_under_way(shot.at, PULSE)] + [shot]
        return True
