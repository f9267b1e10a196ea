"""Who a client is: by the digest of a session's token, or by the operators' token. Shared with the cameras' relay."""

import hmac
import time
from collections.abc import Callable
from typing import NamedTuple

from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.names import is_operator_ticket, is_session_ticket, session_digest
from server.access.attempts import wrong_tokens

# A client that has just signed up may be quicker here than the news of it on /game_status.
SIGN_UP_GRACE = 2.0  # s
MAX_SECRET = 1000  # characters


class Identity(NamedTuple):
    """Who a client is: an operator, somebody with a session (the digest of its token), or a guest."""

    session: str = ""
    operator: bool = False
    foreign: bool = False  # a guest whose page is not the game's


GUEST = Identity()
FOREIGN_GUEST = Identity(foreign=True)
OPERATOR = Identity(operator=True)


def session_identity(token: str) -> Identity:
    """Whoever holds this session token; that it belongs to a player is for /game_status to say."""
    return Identity(session=session_digest(token))


class AttemptsError(Exception):
    """A wrong operator token after too many others from the same address; the text tells the client so."""


class People:
    """Who is signed in, by the newest /game_status, and who proves to be whom."""

    def __init__(self, operator_token: str, clock: Callable[[], float] = time.time) -> None:
        """An empty `operator_token`: nobody is an operator. `clock` tells Unix time in s, by which tickets end."""
        self._operator_token, self._clock = operator_token, clock
        self._wrong_tokens = wrong_tokens()
        self._players: dict[str, UserStatus] = {}  # by session

    def hear(self, status: GameStatus) -> None:
        """The referee has spoken."""
        self._players = {user.session: user for user in status.users if user.session}

    def player(self, who: Identity) -> UserStatus | None:
        """The signed-in player that this is."""
        return self._players.get(who.session)

    def is_operator_token(self, token: str, address: str, now: float) -> bool:
        """Whether it is the token, or a ticket of it. AttemptsError if it is neither, after too many wrong ones from
        that address."""
        if not self._operator_token:
            return False
        is_token = hmac.compare_digest(token.encode(errors="replace"), self._operator_token.encode())
        if is_token or is_operator_ticket(token, self._operator_token, self._clock()):
            return True
        if self._wrong_tokens.take(address, now):
            raise AttemptsError("too many wrong operator tokens came from your address: try again in a few seconds")
        return False

    def proven(self, name: str, secret: str) -> Identity | None:
        """The signed-in player `name`, if that is the token of this player's session or a ticket of it."""
        for user in self._players.values():
            if user.name == name:
                is_token = hmac.compare_digest(session_digest(secret).encode(), user.session.encode())
                if is_token or is_session_ticket(secret, user.session, self._clock()):
                    return Identity(session=user.session)
        return None


class Verdict(NamedTuple):
    """What became of a claim: the identity, a refusal, or neither as long as it waits."""

    identity: Identity | None = None
    refusal: str = ""
    warning: str = ""  # for the operator


class Claim:
    """To be somebody, by a secret that is not known yet, or has not been looked at. Time is a monotonic clock in s."""

    def __init__(self, name: str, secret: str, now: float, request: str | int | float | None = None) -> None:
        """`secret` has MAX_SECRET characters or fewer; `request` is the id of the client's request."""
        self._name, self._secret, self.request = name, secret, request
        self._until = now + SIGN_UP_GRACE
        self._refusal = "no player has this name and this token"
        # the secret has not been compared with the operators' token yet
        self._may_be_operator = name == "operator"

    def judge(self, people: People, address: str, now: float) -> Verdict:
        """To be asked again, as long as it waits, when the battle has changed or some time has passed."""
        warning = ""
        # a player may be called operator, too
        identity = people.proven(self._name, self._secret)
        if identity is None and self._may_be_operator:
            self._may_be_operator = False
            try:
                if people.is_operator_token(self._secret, address, now):
                    identity = OPERATOR
                else:
                    warning = f"wrong operator token from {address}"
            except AttemptsError as error:
                self._refusal = str(error)
        is_refused = identity is None and now >= self._until
        return Verdict(identity, self._refusal if is_refused else "", warning)
