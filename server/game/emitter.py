"""The light by which robots shoot at each other, as far as the referee must know it (docs/protocol-light.md)."""

from dataclasses import dataclass, field

from laser_bot_battle.light_protocol import COOLDOWN, DAMAGES

PULSE = 0.5  # s that the plain light of a shot lasts
# s that a report of a hit may take longer than the news of its shot: the way over radio, robot and serial line
DELAY = 0.3
_EARLY = 0.3  # s that one shot's news may be on its way longer than the next one's; rosbridge has kept the cooldown


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
        """Whether its light, which is over so long after the news, may be what a robot reports now."""
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
