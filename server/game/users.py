"""The signed-in players (manual 3.1.4): a plain registry without locks, owned by the referee."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

FULL_LIFE = 100
AVATARS = 5

_NAME = re.compile(r"[A-Za-z0-9_]{1,16}")


def is_valid_name(name: str) -> bool:
    """Whether `name` is 1 to 16 of ASCII letters, digits and `_`: safe on any page and in any log."""
    return _NAME.fullmatch(name) is not None


@dataclass
class User:
    """A signed-in player. `session` is the SHA-256 (hex) of the session token; all times are monotonic seconds."""

    name: str
    robot: int
    session: str
    avatar: int
    seen: float  # last sign of life of the player's page
    life: int = FULL_LIFE
    ready: bool = False
    died_at: float | None = None  # in the present battle
    left_at: float | None = None

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
            return (3, 0.0)
        if self.died_at is not None:
            return (1, -self.died_at)
        if self.left_at is not None:
            return (2, -self.left_at)
        return (0, -self.life)

    def revive(self) -> None:
        """Full life for a new battle."""
        self.life = FULL_LIFE
        self.died_at = None

    def hit(self, damage: int, now: float) -> None:
        """Lower the life, never below 0."""
        self.life = max(0, self.life - damage)
        if self.life == 0:
            self.died_at = now


class Users:
    """The users, unique by name, in the order of the last ranking with newcomers at the end."""

    def __init__(self) -> None:
        self._users: list[User] = []

    def __iter__(self) -> Iterator[User]:
        return iter(tuple(self._users))

    def get_user(self, name: str) -> User | None:
        return next((user for user in self._users if user.name == name), None)

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

    def clear_users_ready(self) -> None:
        for user in self._users:
            user.ready = False

    def users_sort(self) -> None:
        """Put the users in ranking order; equals keep their order."""
        self._users.sort(key=lambda user: user.standing)
