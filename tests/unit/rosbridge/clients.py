"""Clients without ROS or socket, and what they are answered."""

import hashlib
import json
from typing import Any

from laser_bot_battle.msg import GameStatus, UserStatus
from server.access.identity import OPERATOR, Identity
from server.messages.types import Types
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import Effect, FindType, Log, Send
from server.rosbridge.gate import Gate
from server.rosbridge.graph import Graph
from server.rosbridge.protocol import Client
from tcpros.clock import Clock

# As roslib sends them.
ADVERTISE = (
    '{"op":"advertise","id":"advertise:/Robot3/command:1","type":"laser_bot_battle/Robot_msg",'
    '"topic":"/Robot3/command","latch":false,"queue_size":100}'
)
PUBLISH = (
    '{"op":"publish","id":"publish:/Robot3/command:2","topic":"/Robot3/command",'
    '"msg":{"linear_x":1,"angular_z":-1,"shoot":false},"latch":false}'
)
TOKEN = "the token-of-al"


class Server:
    """All that clients share."""

    def __init__(self) -> None:
        self.gate, self.drivers, self.graph, self.types = Gate("secret"), Drivers(), Graph(), Types()

    def client(self, identity: Identity = OPERATOR) -> Client:
        return Client(self.gate, self.drivers, self.graph, self.types, Clock(), identity)

    def battle(
        self, now: float = 0.0, game: int = GameStatus.PLAYING, robot: int = 3, name: str = "al", coded: bool = False
    ) -> None:
        """al, or who else is named, fights with a robot."""
        session = hashlib.sha256(TOKEN.encode()).hexdigest()
        users = [UserStatus(name=name, robot=robot, life=100, ready=True, session=session)]
        self.gate.update(GameStatus(game=game, users=users, coded=coded), now)


def say(client: Client, now: float = 0.0, /, found: str | None = None, **fields: Any) -> list[Effect]:
    """The effects of a request, log lines apart. When ROS is asked for a topic's type, it says `found`."""
    effects = without_log(client.receive(json.dumps(fields), now))
    if effects and isinstance(effects[0], FindType):
        (asked,) = effects
        assert isinstance(asked, FindType)
        return without_log(asked.done(found, now))
    return effects


def without_log(effects: list[Effect]) -> list[Effect]:
    return [effect for effect in effects if not isinstance(effect, Log)]


def error(effects: list[Effect]) -> dict[str, Any]:
    """The one effect, which is a status of level error."""
    (sent,) = without_log(effects)
    assert isinstance(sent, Send)
    status = json.loads(sent.data)
    assert (status["op"], status["level"]) == ("status", "error")
    return dict(status)
