"""Who may do what: players drive their own robot in a running battle, operators do everything, all others watch.

The gate knows the battle only from /game_status (GameStatus.msg), and players by the SHA-256 of their session token.
Every rule answers with the reason for a refusal, or with an empty string for permission.
"""

import hashlib
import hmac
from typing import Any, NamedTuple

COMMAND_TYPE = "laser_bot_battle/Robot_msg"
STATUS_TOPIC = "/game_status"
STATUS_TYPE = "laser_bot_battle/GameStatus"
PLAYING = 2
# The referee speaks at least every 0.5 s. When it is silent for so long it is gone, and with it every right to drive.
REFEREE_SILENCE = 3.0  # s
# Who has just signed up may be quicker here than the news of it on /game_status.
PATIENCE = 2.0  # s


class Identity(NamedTuple):
    """Who a client is: an operator, somebody with a session token (its SHA-256 in hex), or anybody."""

    session: str = ""
    operator: bool = False


ANYBODY = Identity()
OPERATOR = Identity(operator=True)


class Claim(NamedTuple):
    """A name with a token that the gate does not know yet."""

    name: str
    who: Identity
    id: str | int | None  # of the request
    until: float  # monotonic s


class Player(NamedTuple):
    """A signed-in player as in UserStatus.msg."""

    name: str
    topic: str  # of the commands to the own robot
    ready: bool
    life: int


class Battle(NamedTuple):
    """What the gate needs of one GameStatus message."""

    playing: bool
    players: dict[str, Player]  # by session


def battle_of(status: Any) -> Battle:
    """The battle in a GameStatus message."""
    players = {
        user.session: Player(user.name, command_topic(user.robot), user.ready, user.life)
        for user in status.users
        if user.session
    }
    return Battle(status.game == PLAYING, players)


def command_topic(robot: int) -> str:
    return f"/Robot{robot}/command"


def session_identity(token: str) -> Identity:
    """Whoever holds this session token; that it belongs to a player is for /game_status to say."""
    return Identity(session=hashlib.sha256(token.encode(errors="replace")).hexdigest())


class Gate:
    """The rules, applied to the newest state of the battle."""

    def __init__(self, operator_token: str) -> None:
        """An empty `operator_token`: nobody is an operator."""
        self._operator_token = operator_token.encode()
        self._battle = Battle(False, {})
        self._heard = float("-inf")

    def update(self, battle: Battle, now: float) -> None:
        self._battle, self._heard = battle, now

    def is_operator_token(self, token: str) -> bool:
        given = token.encode(errors="replace")
        return bool(self._operator_token) and hmac.compare_digest(given, self._operator_token)

    def player(self, who: Identity) -> Player | None:
        """The signed-in player that this is."""
        return self._battle.players.get(who.session)

    def refuses_advertising(self, who: Identity, topic: str, type_name: str) -> str:
        if who.operator:
            return ""
        player = self.player(who)
        if player is None:
            return f"only signed-in players and operators may advertise {topic}"
        if topic != player.topic:
            return f"{player.name} may advertise {player.topic} only, not {topic}"
        if type_name != COMMAND_TYPE:
            return f"{topic} is of type {COMMAND_TYPE}, not {type_name}"
        return ""

    def refuses_publishing(self, who: Identity, topic: str, now: float) -> str:
        if who.operator:
            return ""
        player = self.player(who)
        if player is None:
            return f"only signed-in players and operators may publish on {topic}"
        if topic != player.topic:
            return f"{player.name} may publish on {player.topic} only, not {topic}"
        obstacle = self._obstacle(player, now)
        return f"{player.name} may not drive: {obstacle}" if obstacle else ""

    def refuses_subscribing(self, who: Identity, topic: str, type_name: str) -> str:
        if who.operator:
            return ""
        if topic != STATUS_TOPIC:
            return f"only operators may subscribe to {topic}; players and guests to {STATUS_TOPIC}"
        if type_name not in ("", STATUS_TYPE):
            return f"{topic} is of type {STATUS_TYPE}, not {type_name}"
        return ""

    def refuses_calling(self, who: Identity, service: str) -> str:
        return "" if who.operator else f"only operators may call {service}"

    def _obstacle(self, player: Player, now: float) -> str:
        """What keeps a player from driving the own robot, empty when nothing does."""
        if now - self._heard > REFEREE_SILENCE:
            return "nothing heard from the referee"
        if not self._battle.playing:
            return "no battle is running"
        if not player.ready:
            return "not in this battle"
        return "" if player.life > 0 else "dead"
