"""The state of the battle as everyone but its owner sees it: immutable."""

from dataclasses import dataclass, field

from laser_bot_battle.names import Game
from server.game.people import Name
from server.game.pickups import DOUBLE, KINDS, SHIELD
from server.game.sight import FREE, Sides

PLACES = ("hill", *KINDS)


@dataclass(frozen=True, slots=True)
class Player:
    """A signed-in player; `session` is the SHA-256 (hex) of the session token."""

    name: str
    robot: int
    life: int
    ready: bool
    avatar: int
    session: str
    may_join: bool = False  # the battle of others that runs
    fence: Sides = FREE  # where the robot may not drive on: it would leave the floor
    team: int = 0  # in a battle, or chosen for the next one; 0: everybody fights alone, or it will be dealt
    handicap: int = 0  # percent of damage that hits do not take, in a battle or in the next one
    # in the running or the last battle
    hits: int = 0  # shots that have met somebody else, as far as that is known
    kills: int = 0
    points: int = 0  # s alone on hills
    effects: tuple[str, ...] = ()  # of pick-ups, that work now
    shots: int = field(default=0, compare=False)  # nobody has to hear of each at once
    seat_left: float = field(default=0.0, compare=False)  # s until the seat passes on to others; 0: it stays

    @property
    def fence_bits(self) -> int:
        """As in UserStatus.msg."""
        return self.fence.ahead + 2 * self.fence.behind

    @property
    def effect_bits(self) -> int:
        """As in UserStatus.msg."""
        return (SHIELD in self.effects) + 2 * (DOUBLE in self.effects)


@dataclass(frozen=True, slots=True)
class Waiter:
    """Somebody who waits for a robot; place 1 is the next."""

    name: str
    avatar: int
    session: str
    place: int
    offer: int | None  # the robot that this one may take now
    seconds: float = field(compare=False)  # to take it; without an offer, until there may be one


@dataclass(frozen=True, slots=True)
class Placing:
    """A player in the result of a battle: place 1 has won, `left` was gone before the end."""

    name: Name
    robot: int
    life: int
    avatar: int
    place: int
    left: bool
    team: int = 0  # 0: everybody has fought alone
    shots: int = 0  # fired
    hits: int = 0  # of them that have met somebody else, as far as that is known
    kills: int = 0
    taken: int = 0  # hits that have cost life
    points: int = 0  # s alone on hills
    # what no event says
    seconds: float = field(default=0.0, compare=False)  # to the end, or until the player was out
    wins: int = field(default=0, compare=False)  # battles that were won in a row, this one included


@dataclass(frozen=True, slots=True)
class Happening:
    """A hit that has cost life, or one that the rules of place have refused."""

    number: int  # grows by one, through all battles
    name: Name  # who was hit
    by: Name  # who has shot; empty: the light does not tell
    life: int  # that is left
    # of a hit that has taken the last life
    streak: int = 0  # how many the shooter has taken out in this battle, this one included
    revenge: bool = False  # the shooter had been taken out by this one last
    refused: bool = False  # it has cost none

    @property
    def kind(self) -> int:
        """As in GameEvent.msg."""
        return 2 if self.refused else int(self.life == 0)


@dataclass(frozen=True, slots=True)
class Place:
    """A disc on the floor that means something now: a hill, or what lies there. In m."""

    kind: str  # one of PLACES
    x: float
    y: float
    radius: float

    @property
    def number(self) -> int:
        """Of its kind, as in Place.msg."""
        return PLACES.index(self.kind)


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Everything at one moment. Two snapshots are equal when they differ in nothing but times left and the shots."""

    game: Game
    time_left: float = field(compare=False)  # s to the battle (COUNTDOWN) or to its time limit (PLAYING), else 0
    protection: float = field(compare=False)  # s for which nobody can be hit; 0: everybody can
    battle: int  # battles begun so far
    notice: str  # why the last countdown or battle ended; empty while one runs
    paused: bool  # by an operator: the time left stands
    message: str  # of an operator to everybody; empty: none
    free_robots: tuple[int, ...]  # IDs of those that the next players would get
    robots: tuple[int, ...]  # IDs of the registered robots
    players: tuple[Player, ...]  # in ranking order
    queue: tuple[Waiter, ...]  # the next one first
    practice: bool  # whether players may drive without a battle
    practice_beside: bool  # likewise, beside a battle of others
    result: tuple[Placing, ...]  # of the last battle, best first; empty from the next countdown on
    teams: int  # of the running battle, or of the next one; 0: everybody fights alone
    coded: bool  # the light tells who has shot
    hide_cameras: bool  # from spectators, while a battle runs
    damage: int  # life that a shot is to take
    happened: tuple[Happening, ...]  # in the running or the last battle, the newest last
    places: tuple[Place, ...]  # by the rules of place
    tournament: int  # grows with each change of the one that is open; 0: none is

    @property
    def is_open(self) -> bool:
        """Whether somebody may still join the battle that runs."""
        return any(player.may_join for player in self.players)

    @property
    def available_robots(self) -> int:
        return len(self.free_robots)
