"""Who is an operator: by the token itself, or by a session that a browser has got for it."""

import hmac
import secrets
import threading
import time
from collections.abc import Callable

from laser_bot_battle.names import session_digest
from server.access.attempts import PERIOD, wrong_tokens

COOKIE = "laserbot_operator"
SESSION_LIFE = 12 * 3600  # s
MAX_SESSIONS = 100
MAX_NAME = 32  # characters
NAMELESS = "operator"


class WrongTokenError(Exception):
    """It is not the token."""


class TooManyError(Exception):
    """It is not the token, and neither were too many others from that address."""

    retry_after = int(PERIOD)  # s


class Access:
    """Thread-safe. Sessions end with the program: a browser then needs the token again."""

    def __init__(self, token: str, clock: Callable[[], float] = time.monotonic) -> None:
        """Without a token, nobody is an operator."""
        self.is_possible = bool(token)
        self._token = token.encode("utf-8", "replace")
        self._clock = clock
        self._lock = threading.Lock()
        self._wrong_tokens = wrong_tokens()
        self._sessions: dict[str, tuple[str, float]] = {}  # operator's name and end, by digest; the oldest first

    def check(self, token: str, address: str) -> None:
        """WrongTokenError or TooManyError unless it is the token. `address` is the sender's."""
        if self.is_possible and hmac.compare_digest(token.encode("utf-8", "replace"), self._token):
            return
        raise TooManyError if self._wrong_tokens.take(address, self._clock()) else WrongTokenError

    def sign_in(self, token: str, name: str, address: str) -> str:
        """A new session's secret, for the operator of that name; errors as for `check`."""
        self.check(token, address)
        secret = secrets.token_urlsafe(32)
        with self._lock:
            if len(self._sessions) >= MAX_SESSIONS:
                del self._sessions[next(iter(self._sessions))]
            self._sessions[session_digest(secret)] = (name, self._clock() + SESSION_LIFE)
        return secret

    def name(self, secret: str) -> str | None:
        """Of the operator whose session that is, None if it is none."""
        with self._lock:
            name, end = self._sessions.get(session_digest(secret), ("", 0.0))
            return name if self._clock() < end else None

    def sign_out(self, secret: str) -> None:
        with self._lock:
            self._sessions.pop(session_digest(secret), None)
