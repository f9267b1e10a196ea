"""Who may do what: players drive their own robot in a running battle, operators do everything, all others watch.

The gate knows the battle only from /game_status, and players by the digest of their session token.
Every rule answers with the reason for a refusal, or with an empty string for permission.
"""

import hmac
from typing import NamedTuple

from laser_bot_battle.msg import GameStatus, Robot_msg, UserStatus
from laser_bot_battle.names import GAME_STATUS, command_topic, session_digest

COMMAND_TYPE = Robot_msg._type
STATUS_TYPE = GameStatus._type
# The referee speaks at least every 0.5 s. When it is silent for so long it is gone, and with it every right to drive.
REFEREE_SILENCE = 3.0  # s


class Identity(NamedTuple):
    """Who a client is: an operator, somebody with a session (the digest of its token), or a guest."""

    session: str = ""
    operator: bool = False


GUEST = Identity()
OPERATOR = Identity(operator=True)


def session_identity(token: str) -> Identity:
    """Whoever holds this session token; that it belongs to a player is for /game_status to say."""
    return Identity(session=session_digest(token))


class Gate:
    """The rules, applied to the newest state of the battle."""

    def __init__(self, operator_token: str) -> None:
        """An empty `operator_token`: nobody is an operator."""
        self._operator_token = operator_token.encode()
        self._playing = False
        self._players: dict[str, UserStatus] = {}  # by session
        self._heard = float("-inf")

    def update(self, status: GameStatus, now: float) -> None:
        """The referee has spoken."""
        self._playing, self._heard = status.game == GameStatus.PLAYING, now
        self._players = {user.session: user for user in status.users if user.session}

    def is_operator_token(self, token: str) -> bool:
        given = token.encode(errors="replace")
        return bool(self._operator_token) and hmac.compare_digest(given, self._operator_token)

    def player(self, who: Identity) -> UserStatus | None:
        """The signed-in player that this is."""
        return self._players.get(who.session)

    def refuses_advertising(self, who: Identity, topic: str, type_name: str) -> str:
        if who.operator:
            return ""
        if reason := self._not_own(who, "advertise", topic):
            return reason
        return "" if type_name == COMMAND_TYPE else f"{topic} is of type {COMMAND_TYPE}, not {type_name}"

    def refuses_publishing(self, who: Identity, topic: str, now: float) -> str:
        if who.operator:
            return ""
        if reason := self._not_own(who, "publish on", topic):
            return reason
        player = self._players[who.session]
        if now - self._heard > REFEREE_SILENCE:
            obstacle = "nothing heard from the referee"
        elif not self._playing:
            obstacle = "no battle is running"
        elif not player.ready:
            obstacle = "not in this battle"
        elif player.life == 0:
            obstacle = "dead"
        else:
            return ""
        return f"{player.name} may not drive: {obstacle}"

    def refuses_subscribing(self, who: Identity, topic: str, type_name: str) -> str:
        if who.operator:
            return ""
        if topic != GAME_STATUS:
            return f"only operators may subscribe to {topic}; players and guests to {GAME_STATUS}"
        if type_name not in ("", STATUS_TYPE):
            return f"{topic} is of type {STATUS_TYPE}, not {type_name}"
        return ""

    def refuses_calling(self, who: Identity, service: str) -> str:
        return "" if who.operator else f"only operators may call {service}"

    def _not_own(self, who: Identity, verb: str, topic: str) -> str:
        """Why this is not the command topic of a player's own robot."""
        player = self.player(who)
        if player is None:
            return f"only signed-in players and operators may {verb} {topic}"
        own = command_topic(player.robot)
        return "" if topic == own else f"{player.name} may {verb} {own} only, not {topic}"
