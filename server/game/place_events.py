"""What is decided by where the robots are (server.game.events)."""

from dataclasses import dataclass

from server.game.people import Name


@dataclass(frozen=True, slots=True)
class Fenced:
    """A robot may not drive on, since it would leave the floor, or may again."""

    name: Name  # who drives it
    robot: int
    ahead: bool
    behind: bool

    def __str__(self) -> str:
        if not (self.ahead or self.behind):
            return f"{self.name} (robot {self.robot}) is clear of the floor's edge"
        way = "either way" if self.ahead and self.behind else "forwards" if self.ahead else "backwards"
        return f"{self.name} (robot {self.robot}) is at the floor's edge and cannot drive on {way}"


@dataclass(frozen=True, slots=True)
class HitRefused:
    """A coded shot was received where the shooter's light cannot have gone, so it costs no life."""

    name: Name  # who received it
    robot: int
    life: int  # that is left
    by: Name  # the player who has shot

    def __str__(self) -> str:
        return f"a hit of {self.by} on {self.name} (robot {self.robot}) does not count: not in the line of fire"


@dataclass(frozen=True, slots=True)
class HillOpened:
    """A hill of the floor counts in this battle."""

    zone: str  # where, as the floor's file names it
    x: float  # m, of its middle
    y: float
    radius: float

    def __str__(self) -> str:
        return f"the hill {self.zone} can be held"


@dataclass(frozen=True, slots=True)
class HillHeld:
    """A fighter has held a hill, alone or with the own team, for another second."""

    name: Name
    robot: int
    points: int  # the fighter's in this battle, this one included
    x: float  # m, of the hill's middle
    y: float
    radius: float

    def __str__(self) -> str:
        return f"{self.name} (robot {self.robot}) holds the hill, {self.points} s so far"


@dataclass(frozen=True, slots=True)
class PickUpLaid:
    """Something lies on the floor for whoever drives over it first."""

    zone: str  # where, as the floor's file names it
    kind: str  # one of pickups.KINDS
    x: float  # m, of its middle
    y: float
    radius: float

    def __str__(self) -> str:
        return f"a pick-up, {self.kind}, lies at {self.zone}"


@dataclass(frozen=True, slots=True)
class PickedUp:
    name: Name
    robot: int
    zone: str
    kind: str
    life: int  # after a repair, too
    seconds: float  # for which it works; 0: it has worked at once

    def __str__(self) -> str:
        lasts = f" for {self.seconds:g} s" if self.seconds else f", life {self.life}"
        return f"{self.name} (robot {self.robot}) picks up {self.kind} at {self.zone}{lasts}"


@dataclass(frozen=True, slots=True)
class EffectEnded:
    """What was picked up works no longer."""

    name: Name
    robot: int
    kind: str

    def __str__(self) -> str:
        return f"{self.kind} has ended for {self.name} (robot {self.robot})"


PlaceEvent = Fenced | HitRefused | HillOpened | HillHeld | PickUpLaid | PickedUp | EffectEnded
