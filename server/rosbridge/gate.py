"""Who may do what: players drive their own robot in a running battle, and to practise before it, operators do
everything, all others watch.

The gate knows the battle only from /game_status, and players by the digest of their session token.
Every rule answers with the reason for a refusal, or with an empty string for permission.
"""

import io
import struct
import time
from collections.abc import Callable

from laser_bot_battle.msg import GameStatus, OverheadCovered, OverheadView, Positions, Robot_msg, Shot, UserStatus
from laser_bot_battle.names import GAME_STATUS, OVERHEAD_COVERED, OVERHEAD_VIEW, POSITIONS, SHOTS, command_topic
from server.access.globs import Globs
from server.access.identity import Identity, People
from server.websocket.requests import RequestError

COMMAND_TYPE = Robot_msg._type
STATUS_TYPE = GameStatus._type
# what everybody may look at, and its type
PUBLIC = {
    GAME_STATUS: STATUS_TYPE,
    POSITIONS: Positions._type,
    SHOTS: Shot._type,
    OVERHEAD_VIEW: OverheadView._type,
    OVERHEAD_COVERED: OverheadCovered._type,
}
# The referee speaks at least every 0.5 s. When it is silent for so long it is gone, and with it every right to drive.
REFEREE_SILENCE = 3.0  # s
NO_GLOBS = Globs()
GET_TIME = "/rosapi/get_time"  # players measure by it how long their commands are on the way
_COMMAND = struct.Struct("<bbB")  # a serialized Robot_msg


class Gate(People):
    """The rules, applied to the newest state of the battle."""

    def __init__(self, operator_token: str, globs: Globs = NO_GLOBS, clock: Callable[[], float] = time.time) -> None:
        """What `globs` leave out is refused to operators, too."""
        super().__init__(operator_token, clock)
        self._globs = globs
        self._playing = self._practising = self._beside = self._paused = False
        self.coded = False
        """whether the robots' light is coded"""
        self._heard = float("-inf")
        self.refusals = dict.fromkeys(("publish", "advertise", "subscribe", "call_service", "advertise_service"), 0)
        """how often clients were refused something, by operation"""

    def silence(self, now: float) -> float:
        """The s since the referee has spoken; infinity: never."""
        return now - self._heard

    def refusal(self, operation: str, reason: str) -> RequestError:
        """For a client to whom that is refused."""
        self.refusals[operation] += 1
        return RequestError(reason)

    def update(self, status: GameStatus, now: float) -> None:
        """The referee has spoken."""
        self._playing, self._heard = status.game == GameStatus.PLAYING, now
        self._paused, self.coded = status.paused, status.coded
        self._practising = status.practice and status.game == GameStatus.STOPPED
        self._beside = status.practice_beside
        self.hear(status)

    @staticmethod
    def public(status: bytes) -> bytes:
        """What clients may know of a serialized GameStatus: with a session's digest they could make tickets, and act
        for its player."""
        message = GameStatus().deserialize(status)
        for user in (*message.users, *message.result):
            user.session = ""
        buffer = io.BytesIO()
        message.serialize(buffer)
        return buffer.getvalue()

    def refuses_advertising(self, who: Identity, topic: str, type_name: str) -> str:
        if who.operator:
            return self._hidden_topic(topic)
        if reason := self._not_own(who, "advertise", topic):
            return reason
        return "" if type_name == COMMAND_TYPE else f"{topic} is of type {COMMAND_TYPE}, not {type_name[:80]}"

    def refuses_publishing(self, who: Identity, topic: str, now: float) -> str:
        if who.operator:
            return self._hidden_topic(topic)
        if reason := self._not_own(who, "publish on", topic):
            return reason
        player = self._players[who.session]
        if now - self._heard > REFEREE_SILENCE:
            obstacle = "nothing heard from the referee"
        elif self._practising:
            return ""
        elif not self._playing:
            obstacle = "no battle is running"
        elif self._paused:
            obstacle = "the battle is paused"
        elif not player.ready and not self._beside:
            obstacle = "not in this battle"
        elif player.ready and player.life == 0:
            obstacle = "dead"
        else:
            return ""
        return f"{player.name} may not drive: {obstacle}"

    def check_command(self, who: Identity, command: bytes) -> None:
        """RequestError when `command`, a serialized Robot_msg, is none that a player has keys for."""
        linear_x, angular_z, _ = _COMMAND.unpack(command)
        if who.operator or (abs(linear_x) <= 1 and abs(angular_z) <= 1):
            return
        raise self.refusal("publish", f"linear_x and angular_z must be -1, 0 or 1, not {linear_x} and {angular_z}")

    def granted(self, who: Identity, command: bytes) -> bytes:
        """What the robot gets of a serialized Robot_msg: whoever only practises beside a battle has no light there, and
        nobody drives on at the floor's edge."""
        player = self.player(who)
        if player is None or who.operator:
            return command
        linear_x, angular_z, shoot = _COMMAND.unpack(command)
        if player.fence & (UserStatus.AHEAD if linear_x > 0 else UserStatus.BEHIND if linear_x < 0 else 0):
            linear_x = 0
        return _COMMAND.pack(linear_x, angular_z, shoot if player.ready or not self._playing else 0)

    def refuses_subscribing(self, who: Identity, topic: str, type_name: str) -> str:
        if who.operator:
            return self._hidden_topic(topic)
        if topic not in PUBLIC:
            return f"only operators may subscribe to {topic}; players and guests to {', '.join(PUBLIC)}"
        if type_name not in ("", PUBLIC[topic]):
            return f"{topic} is of type {PUBLIC[topic]}, not {type_name[:80]}"
        return ""

    def refuses_calling(self, who: Identity, service: str) -> str:
        if who.operator:
            return self._hidden_service(service)
        if service != GET_TIME:
            return f"only operators may call {service}"
        return "" if self.player(who) else f"only signed-in players and operators may call {service}"

    def refuses_offering(self, who: Identity, service: str) -> str:
        return self._hidden_service(service) if who.operator else f"only operators may offer {service}"

    def _hidden_topic(self, topic: str) -> str:
        return "" if self._globs.allows_topic(topic) else f"LASERBOT_TOPICS_GLOB leaves {topic} out"

    def _hidden_service(self, service: str) -> str:
        return "" if self._globs.allows_service(service) else f"LASERBOT_SERVICES_GLOB leaves {service} out"

    def _not_own(self, who: Identity, verb: str, topic: str) -> str:
        """Why this is not the command topic of a player's own robot."""
        player = self.player(who)
        if player is None:
            return f"only signed-in players and operators may {verb} {topic}"
        own = command_topic(player.robot)
        return "" if topic == own else f"{player.name} may {verb} {own} only, not {topic}"
