"""What the referee decides. Nothing else changes the game, so a battle can be played again from its events.

Each event's `str` is the line of log for people. `by` is the name of the operator who decided it; empty: the rules did.
What names a person, or may do so, has a type of `server.game.people`: by that, who is forgotten is found.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from server.game.people import Cause, How, Name, Words, signature
from server.game.place_events import EffectEnded, Fenced, HillHeld, HillOpened, HitRefused, PickedUp, PickUpLaid
from server.game.snapshot import Placing
from server.game.tournament_events import (
    GameWon,
    MatchCalled,
    MatchCorrected,
    NoShow,
    TournamentClosed,
    TournamentOpened,
)


@dataclass(frozen=True, slots=True)
class RobotCame:
    robot: int
    caller: str | None  # ROS name of its client, None if that has no lasting one
    key: str = ""  # SHA-256 (hex) of what its pings show
    address: str = ""  # from which it registered

    def __str__(self) -> str:
        return f"robot {self.robot} registered by {self.caller or 'an unnamed client'}"


@dataclass(frozen=True, slots=True)
class RobotRefused:
    caller: str

    def __str__(self) -> str:
        return "a robot was refused: all IDs are in use, or kept for robots that were here before"


@dataclass(frozen=True, slots=True)
class RobotLinked:
    """Its serial node has come to its topics, or left them."""

    robot: int
    linked: bool
    caller: str | None

    def __str__(self) -> str:
        return f"robot {self.robot} is {'on its topics' if self.linked else 'not on its topics any more'}"


@dataclass(frozen=True, slots=True)
class RobotGone:
    robot: int

    def __str__(self) -> str:
        return f"robot {self.robot} is gone"


@dataclass(frozen=True, slots=True)
class SignedUp:
    name: Name
    robot: int
    session: str  # SHA-256 (hex) of the session token
    avatar: int
    address: str = ""  # a mark of the page's

    def __str__(self) -> str:
        return f"{self.name} signed up and drives robot {self.robot}"


@dataclass(frozen=True, slots=True)
class Queued:
    """Waits for a robot, behind all who do already."""

    name: Name
    session: str
    avatar: int
    address: str = ""

    def __str__(self) -> str:
        return f"{self.name} waits for a robot"


@dataclass(frozen=True, slots=True)
class Offered:
    """A robot is kept for somebody in the queue."""

    name: Name
    robot: int
    seconds: float  # to take it

    def __str__(self) -> str:
        return f"robot {self.robot} is offered to {self.name} for {self.seconds:g} s"


@dataclass(frozen=True, slots=True)
class OfferMissed:
    """Has not taken the robot that was offered, and waits behind the next one."""

    name: Name

    @property
    def how(self) -> str:
        """After the name."""
        return "did not take the robot in time"

    def __str__(self) -> str:
        return f"{self.name} {self.how}: the next one gets it"


@dataclass(frozen=True, slots=True)
class Seated:
    """Has taken the robot that was offered."""

    name: Name

    def __str__(self) -> str:
        return f"{self.name} has taken the robot"


@dataclass(frozen=True, slots=True)
class Unseated:
    """Gives the robot up for others, and waits behind them."""

    name: Name
    how: How  # after the name: "was not ready for 60 s while others waited"
    first: bool = False  # waits before the others instead, since it is nobody's fault

    def __str__(self) -> str:
        return f"{self.name} {self.how}: the seat is free"


@dataclass(frozen=True, slots=True)
class Left:
    name: Name
    how: How  # after the name: "signed out", "left the page", "lost the robot"
    by: Name = ""

    def __str__(self) -> str:
        return f"{self.name} {self.how}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class ReadyChanged:
    name: Name
    ready: bool

    def __str__(self) -> str:
        return f"{self.name} is {'ready' if self.ready else 'no longer ready'}"


@dataclass(frozen=True, slots=True)
class TeamChosen:
    """For the battles to come."""

    name: Name
    team: int  # 0: the referee deals it

    def __str__(self) -> str:
        return f"{self.name} wants to be in team {self.team}" if self.team else f"{self.name} leaves the team open"


@dataclass(frozen=True, slots=True)
class CountdownStarted:
    seconds: float
    by: Name = ""  # without waiting for anybody

    def __str__(self) -> str:
        return f"countdown started: {self.seconds:g} s{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class CountdownStopped:
    cause: Cause
    by: Name = ""  # by an operator: nobody is ready any more, else it would begin again at once

    @property
    def notice(self) -> str:
        """For the players."""
        return f"Countdown stopped: {self.cause}{'' if self.by else ', fewer than two players are ready'}."

    def __str__(self) -> str:
        return f"{self.notice}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class Held:
    """No countdown begins: something that a battle needs is about to restart."""

    what: str  # "robot 1", "the server"

    @property
    def notice(self) -> str:
        """For the players."""
        return f"The next battle waits: {self.what} is about to restart."

    def __str__(self) -> str:
        return f"the next battle waits: {self.what} is about to restart"


@dataclass(frozen=True, slots=True)
class Released:
    """Countdowns begin again."""

    what: str

    def __str__(self) -> str:
        return f"battles no longer wait for the restart of {self.what}"


@dataclass(frozen=True, slots=True)
class Fighter:
    """Somebody who takes part in a battle."""

    name: Name
    robot: int
    avatar: int
    team: int = 0  # 0: fights alone
    handicap: int = 0  # percent of damage that hits do not take


@dataclass(frozen=True, slots=True)
class BattleStarted:
    battle: int
    seconds: float  # to its time limit
    fighters: tuple[Fighter, ...]
    by: Name = ""  # before the countdown was over
    teams: int = 0  # 0: everybody fights alone
    protection: float = 0.0  # s in which nobody can be hit

    def __str__(self) -> str:
        names = ", ".join(
            f"{fighter.name} (team {fighter.team})" if fighter.team else fighter.name for fighter in self.fighters
        )
        return f"battle {self.battle} started: {names}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class Joined:
    """Fights from now on in the battle that runs, alone."""

    name: Name
    robot: int
    avatar: int
    life: int
    handicap: int = 0

    def __str__(self) -> str:
        return f"{self.name} (robot {self.robot}) joins the battle, life {self.life}"


@dataclass(frozen=True, slots=True)
class Hit:
    name: Name  # who was hit
    robot: int
    life: int  # that is left
    by: Name = ""  # the player who has shot; empty: the light does not tell

    def __str__(self) -> str:
        shooter = f" by {self.by}" if self.by else ""
        return f"{self.name} (robot {self.robot}) has been hit{shooter}, life {self.life}"


@dataclass(frozen=True, slots=True)
class BattleEnded:
    battle: int
    cause: Cause
    result: tuple[Placing, ...]  # best first
    counts: bool = True  # False: aborted, so nobody has won it
    by: Name = ""

    def __str__(self) -> str:
        ranking = ", ".join(f"{placing.place} {placing.name}" for placing in self.result)
        return f"battle {self.battle} over: {self.cause}; ranking: {ranking}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class StoodStill:
    seconds: float

    def __str__(self) -> str:
        return f"the server stood still for {self.seconds:.1f} s: robots and pages get that much more time"


@dataclass(frozen=True, slots=True)
class Paused:
    """The clock of countdown or battle stands, no hit counts, nobody drives."""

    by: Name

    def __str__(self) -> str:
        return f"paused{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class Resumed:
    by: Name

    def __str__(self) -> str:
        return f"goes on{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class TimeAdded:
    """To the countdown or the battle."""

    seconds: float
    by: Name

    def __str__(self) -> str:
        return f"{self.seconds:g} s added{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class RulesChanged:
    """From now on; time limits of what runs stay."""

    changes: Mapping[str, Any]  # new values by names in `Rules`; None: the environment's again
    by: Name

    def __str__(self) -> str:
        changes = ", ".join(
            f"{rule} {'as configured' if value is None else value}" for rule, value in self.changes.items()
        )
        return f"rules changed: {changes}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class PresetSaved:
    """A set of rules is kept, instead of one of the same name."""

    preset: Words
    rules: Mapping[str, Any]  # values by names in `Rules`; None: the environment's
    by: Name

    def __str__(self) -> str:
        return f"the rules are saved as the preset {self.preset}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class PresetRemoved:
    preset: Words
    by: Name

    def __str__(self) -> str:
        return f"the preset {self.preset} is removed{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class ServiceChanged:
    """A robot is taken out of service, or put back. Out of service, nobody gets it."""

    robot: int
    in_service: bool
    by: Name

    def __str__(self) -> str:
        return f"robot {self.robot} is {'back in' if self.in_service else 'out of'} service{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class BotChosen:
    """A robot is given to a bot of that level (server.game.bots), or with "" taken back."""

    robot: int
    level: str
    by: Name

    def __str__(self) -> str:
        what = f"is for a bot ({self.level})" if self.level else "is for people only"
        return f"robot {self.robot} {what}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class NameBanned:
    name: Name
    by: Name

    def __str__(self) -> str:
        return f"the name {self.name} is banned{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class NameUnbanned:
    name: Name
    by: Name

    def __str__(self) -> str:
        return f"the name {self.name} is allowed again{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class WordsChanged:
    """The words that no new name may contain."""

    words: tuple[str, ...]
    by: Name

    def __str__(self) -> str:
        return f"{len(self.words)} words are not allowed in names{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class MessageShown:
    """To everybody, until the next one."""

    text: Words  # "": none any more
    by: Name

    def __str__(self) -> str:
        what = f"message to everybody: {self.text}" if self.text else "the message to everybody is taken back"
        return f"{what}{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class DriveTaken:
    """An operator may drive robots for some seconds."""

    by: Name

    def __str__(self) -> str:
        return f"the controls for a test drive were handed out{signature(self.by)}"


@dataclass(frozen=True, slots=True)
class FloorChanged:
    """It has other walls, start places or zones."""

    by: Name

    def __str__(self) -> str:
        return f"the floor was changed{signature(self.by)}"


Event = (
    RobotCame
    | RobotRefused
    | RobotLinked
    | RobotGone
    | SignedUp
    | Queued
    | Offered
    | OfferMissed
    | Seated
    | Unseated
    | Left
    | ReadyChanged
    | TeamChosen
    | CountdownStarted
    | CountdownStopped
    | Held
    | Released
    | BattleStarted
    | Joined
    | Hit
    | Fenced
    | HitRefused
    | HillOpened
    | HillHeld
    | PickUpLaid
    | PickedUp
    | EffectEnded
    | BattleEnded
    | StoodStill
    | Paused
    | Resumed
    | TimeAdded
    | RulesChanged
    | PresetSaved
    | PresetRemoved
    | ServiceChanged
    | BotChosen
    | NameBanned
    | NameUnbanned
    | WordsChanged
    | MessageShown
    | DriveTaken
    | FloorChanged
    | TournamentOpened
    | MatchCalled
    | GameWon
    | NoShow
    | MatchCorrected
    | TournamentClosed
)

_TUPLES = {"words", "names", "robots"}  # fields

# the classes by the names under which events are kept
KINDS: Mapping[str, type[Event]] = {kind.__name__: kind for kind in Event.__args__}


@dataclass(frozen=True, slots=True)
class Recorded:
    """An event and when it was decided, in monotonic seconds."""

    at: float
    event: Event


def kind_of(event: Event) -> str:
    """The name under which an event is kept."""
    return type(event).__name__


def to_json(event: Event) -> dict[str, Any]:
    """The event's fields, as JSON knows them."""
    return asdict(event)


def from_json(kind: str, fields: Mapping[str, Any]) -> Event:
    """The event that `kind_of` and `to_json` describe. ValueError for anything else."""
    try:
        given = dict(fields)
        if "fighters" in given:
            given["fighters"] = tuple(Fighter(**fighter) for fighter in given["fighters"])
        if "result" in given:
            given["result"] = tuple(Placing(**placing) for placing in given["result"])
        for field in _TUPLES & given.keys():
            given[field] = tuple(given[field])
        event: Event = KINDS[kind](**given)
    except (KeyError, TypeError) as error:
        raise ValueError(f"no event {kind!r} of {fields!r}: {error}") from None
    return event
