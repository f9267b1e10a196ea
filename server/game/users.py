"""The signed-in players (manual 3.1.4) and those who wait to be one: plain data without locks, owned by the referee."""

import re
import unicodedata
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from server.game.people import MAX_NAME, NEUTRAL, Name
from server.game.sight import FREE, Sides

FULL_LIFE = 100
AVATARS = 5
FIGHTING, DEAD, QUIT, WATCHING = range(4)  # how a player may stand, best first

# who these names belong to is not for players to say
_RESERVED = {"operator", "admin", "referee", "server", "master", "laserbot", "everybody", "nobody"}
_ROBOT = re.compile(r"robot ?[0-9]+")

# letters and marks of which nothing is to be seen (Unicode's Default_Ignorable_Code_Point): two names would look alike
_UNSEEN = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]")


def is_valid_name(name: str) -> bool:
    """Whether `name` is 1 to 16 letters, digits (of any script, in NFC), `_` and single spaces between them.

    It is safe on any page and in any log.
    """
    words = all(_is_word(word) for word in name.split(" "))
    return words and len(name) <= MAX_NAME and unicodedata.is_normalized("NFC", name)


def _is_word(word: str) -> bool:
    allowed = all(char == "_" or unicodedata.category(char)[0] in "LMN" for char in word)
    starts = word[:1] == "_" or unicodedata.category(word[:1] or " ")[0] in "LN"
    return allowed and starts and not _UNSEEN.search(word)


def is_reserved_name(name: str) -> bool:
    """Whether it could be taken for a part of the game, or for those who run it."""
    folded = _folded(name)
    return folded in _RESERVED or any(pattern.fullmatch(folded) for pattern in (_ROBOT, NEUTRAL))


def contains_word(name: str, word: str) -> bool:
    """Whether `name` contains `word`, without regard to case and to forms of a letter."""
    return _folded(word) in _folded(name)


def is_same_name(one: str, other: str) -> bool:
    """Whether people would take them for the same: without regard to case and to forms of a letter."""
    return _folded(one) == _folded(other)


def _folded(name: str) -> str:
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


@dataclass
class User:
    """A signed-in player. `session` is the SHA-256 (hex) of the session token; all times are monotonic seconds."""

    name: Name
    robot: int
    session: str
    avatar: int
    seen: float  # last sign of life of the player's page
    life: int = FULL_LIFE
    ready: bool = False
    died_at: float | None = None  # in the present battle
    left_at: float | None = None
    idle_since: float = 0.0  # when the player would have begun to be not ready, had it been at one stretch
    ready_since: float = 0.0
    robot_gone_at: float | None = None  # when the robot fell silent; None while it is there
    seated_at: float = 0.0
    battles: int = 0  # since the player has this seat
    address: str = ""  # a mark of the page's, "" if it is not known
    wish: int = 0  # the team that the player has chosen; 0: none
    fence: Sides = FREE  # where the robot may not drive on
    # of the running or the last battle
    fights_since: float = 0.0
    team: int = 0  # 0: fights alone
    handicap: int = 0  # percent of damage that hits do not take
    shots: int = 0
    hits: int = 0  # shots that have met somebody else, as far as that is known
    kills: int = 0
    taken: int = 0  # hits of others that have cost life
    points: int = 0  # s on hills that nobody else was on
    effects: dict[str, float] = field(default_factory=dict)  # of pick-ups, by kind: until when they work

    @property
    def is_fighting(self) -> bool:
        """Ready and alive: what counts as alive in a battle."""
        return self.ready and self.life > 0

    @property
    def standing(self) -> tuple[int, float]:
        """Sort key of a ranking, best first; equal keys share a place.

        The living by life, then the dead by the time of death and the quitters by the time of leaving, both latest
        first, then those who do not play. Who leaves after death stays among the dead.
        """
        if not self.ready:
            return (WATCHING, 0.0)
        if self.died_at is not None:
            return (DEAD, -self.died_at)
        if self.left_at is not None:
            return (QUIT, -self.left_at)
        return (FIGHTING, -self.life)

    def enter_battle(self, team: int, handicap: int, now: float) -> None:
        """From now on the player fights for that team, with that handicap."""
        self.team, self.handicap, self.fights_since = team, handicap, now
        self.shots = self.hits = self.kills = self.taken = self.points = 0
        self.effects = {}

    def fought(self, now: float) -> float:
        """s in the battle, which is over now: to the end, or until the player was out."""
        out = [at for at in (self.died_at, self.left_at) if at is not None]
        return min(out, default=now) - self.fights_since

    def revive(self) -> None:
        """Full life for a new battle."""
        self.life = FULL_LIFE
        self.died_at = None

    def wound(self, life: int, now: float) -> None:
        """After a hit, `life` is left."""
        self.life = life
        self.taken += 1
        if life == 0:
            self.died_at = now


@dataclass
class Waiting:
    """Somebody who has signed up and waits for a robot. All times are monotonic seconds."""

    name: Name
    session: str
    avatar: int
    seen: float  # last sign of life of the page
    since: float
    offer: int | None = None  # the robot that is kept for this one
    offer_ends: float = 0.0
    passed_on: bool = False  # has given up a seat since the last battle: for this one nobody else does
    missed: bool = False  # has not taken a robot that was offered
    first: bool = False  # has lost a seat by nobody's fault: only others of that kind stand before
    address: str = ""


class Users:
    """The users, unique by name, in the order of the last ranking with newcomers at the end."""

    def __init__(self) -> None:
        self._users: list[User] = []

    def __iter__(self) -> Iterator[User]:
        return iter(tuple(self._users))

    def get_user(self, name: str) -> User | None:
        return next((user for user in self._users if user.name == name), None)

    def user(self, name: str) -> User:
        """KeyError when there is none."""
        found = self.get_user(name)
        if found is None:
            raise KeyError(f"no user {name}")
        return found

    def get_session_user(self, session: str) -> User | None:
        return next((user for user in self._users if user.session == session), None)

    def add_user(self, user: User) -> None:
        """ValueError when the name is taken."""
        if self.get_user(user.name) is not None:
            raise ValueError(f"the name {user.name} is taken")
        self._users.append(user)

    def del_user(self, user: User) -> None:
        self._users.remove(user)

    def get_users_ready(self) -> list[User]:
        return [user for user in self._users if user.ready]

    def get_users_alive(self) -> list[User]:
        return [user for user in self._users if user.is_fighting]

    def put_in_order(self, ordered: Iterable[User]) -> None:
        """`ordered` has the users in another order."""
        self._users = list(ordered)
