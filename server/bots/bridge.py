"""What a bot does by rosbridge: it hears what everybody may hear, and drives its robot."""

import asyncio
import json
import logging
from typing import NoReturn

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from laser_bot_battle.names import GAME_STATUS, POSITIONS, command_topic
from server.bots.game import Floor, Positions, Status
from server.bots.mind import Command
from server.bots.paths import Paths
from server.bots.sight import Sight

RETRY = 1.0  # s between attempts to connect
ANSWER = 5.0  # s
AWAY = (OSError, TimeoutError, WebSocketException)  # what says that rosbridge is not there

_log = logging.getLogger(__name__)


def connected(url: str, cookies: dict[str, str]) -> connect:
    """A connection to rosbridge, for an `async with`."""
    return connect(
        url,
        additional_headers=cookies,
        compression=None,
        proxy=None,
        open_timeout=ANSWER,
        close_timeout=ANSWER,
        ping_interval=ANSWER,
        ping_timeout=ANSWER,
    )


class Feed:
    """The battle's state, and where the robots are, for all bots by one connection of a guest."""

    def __init__(self, url: str) -> None:
        self.url = url
        self.status: Status | None = None
        """None while rosbridge is away"""
        self.sight = Sight()
        self._unclear = ""
        self._planning = asyncio.Lock()
        self._planned: tuple[Floor, Paths] | None = None

    async def paths_on(self, floor: Floor) -> Paths:
        """Planned once for all bots, and beside the loop that drives them: a large floor takes seconds."""
        async with self._planning:
            if self._planned is None or self._planned[0] != floor:
                self._planned = floor, await asyncio.to_thread(Paths, floor.width, floor.height, floor.walls)
            return self._planned[1]

    async def follow(self) -> NoReturn:
        """For ever, also when rosbridge is restarted."""
        while True:
            try:
                async with connected(self.url, {}) as socket:
                    await _send(socket, op="subscribe", topic=GAME_STATUS)
                    # by its type, nobody has to publish it yet
                    await _send(socket, op="subscribe", topic=POSITIONS, type="laser_bot_battle/Positions")
                    async for text in socket:
                        self._take(text)
            except AWAY:
                pass
            finally:
                self.status = None
            await asyncio.sleep(RETRY)

    def _take(self, text: str | bytes) -> None:
        try:
            message = json.loads(text)
            match message.get("op"), message.get("topic"):
                case "publish", topic if topic == GAME_STATUS:
                    self.status = Status.from_message(message["msg"])
                case "publish", topic if topic == POSITIONS:
                    self.sight.see(asyncio.get_running_loop().time(), Positions.from_message(message["msg"]))
                case _:
                    _note(message)
        except (ArithmeticError, AttributeError, KeyError, TypeError, ValueError) as error:
            if repr(error) != self._unclear:  # once: /positions come 15 times a second
                _log.warning("cannot understand a message from rosbridge: %r", error)
            self._unclear = repr(error)


class Wheel:
    """An open connection that may drive one robot: the session's cookie, sent with it, says who drives."""

    def __init__(self, socket: ClientConnection, robot: int) -> None:
        self._socket = socket
        self._topic = command_topic(robot)

    async def start(self) -> None:
        await _send(self._socket, op="advertise", topic=self._topic, type="laser_bot_battle/Robot_msg")

    async def command(self, command: Command) -> None:
        fields = {"linear_x": command.linear_x, "angular_z": command.angular_z, "shoot": command.shoot}
        await _send(self._socket, op="publish", topic=self._topic, msg=fields)

    async def hold(self) -> None:
        """Until the connection ends."""
        async for text in self._socket:
            try:
                _note(json.loads(text))
            except (AttributeError, ValueError) as error:
                _log.warning("cannot understand a message from rosbridge: %r", error)


async def _send(socket: ClientConnection, **message: object) -> None:
    await socket.send(json.dumps(message))


def _note(message: dict[str, object]) -> None:
    """Log what rosbridge complains of."""
    if message.get("op") == "status" and message.get("level") in {"error", "warning"}:
        _log.warning("rosbridge: %s", message.get("msg"))
