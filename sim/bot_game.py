"""What a browser can do in the battle: HTTP calls, rosbridge and the arena's public view."""

import asyncio
import json
import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

import aiohttp

from laser_bot_battle.geometry import Pose, Wall
from laser_bot_battle.names import GAME_STATUS, command_topic
from sim.bot_mind import Command

RETRY = 1.0  # s between attempts to connect
BLIND_AFTER = 1.0  # s without a state of the arena

_log = logging.getLogger(__name__)


class GameError(Exception):
    """The web server does not answer, or not as it should; the text says why."""


@dataclass(frozen=True)
class Player:
    """A signed-in player as /game_status shows it."""

    name: str
    robot: int
    life: int
    ready: bool


@dataclass(frozen=True)
class Status:
    """The battle's state: `game` is one of the constants in GameStatus.msg."""

    game: int
    players: tuple[Player, ...]
    paused: bool = False
    protection: float = 0.0  # s for which nobody can be hit
    hits: tuple[tuple[int, str], ...] = ()  # the last ones: their numbers, which grow, and who was hit

    @classmethod
    def from_message(cls, message: Mapping[str, Any]) -> "Status":
        """From a GameStatus as rosbridge sends it; KeyError, TypeError or ValueError if it is not one."""
        players = tuple(
            Player(str(user["name"]), int(user["robot"]), int(user["life"]), bool(user["ready"]))
            for user in message["users"]
        )
        hits = tuple((int(event["number"]), str(event["name"])) for event in message["events"])
        protection = float(message.get("protection", 0))  # an older master knows none
        return cls(int(message["game"]), players, bool(message["paused"]), protection, hits)


class Web:
    """The web server's HTTP interface, as the player's page uses it."""

    def __init__(self, http: aiohttp.ClientSession, url: str) -> None:
        self._http = http
        self._url = url
        self._answered_at = asyncio.get_running_loop().time()

    @property
    def silence(self) -> float:
        """For how many s the server has not answered."""
        return asyncio.get_running_loop().time() - self._answered_at

    async def look(self) -> tuple[set[int], set[str]]:
        """The robots that are free, and the names that are taken."""
        free, names = await self._post("getAvailableRobots", data="data"), await self._names()
        try:
            return {int(robot) for robot in free["robots"]}, names
        except (KeyError, TypeError, ValueError) as error:
            raise GameError(f"cannot understand which robots are free: {error!r}") from None

    async def sign_up(self, name: str, robot: int | None) -> dict[str, Any]:
        """As `name`, with a wish for that robot or (None) any."""
        return await self._post("signUpUser", data=name, **({} if robot is None else {"robot": str(robot)}))

    async def sign_out(self, name: str) -> dict[str, Any]:
        return await self._post("signOutUser", data=name)

    async def set_ready(self, name: str, ready: bool) -> dict[str, Any]:
        return await self._post("playerReady", user=name, ready=str(int(ready)))

    async def is_signed_in(self, name: str) -> bool:
        """Also a sign of life, which the server wants at least every 15 s."""
        return name in await self._names()

    async def _names(self) -> set[str]:
        """Of those who play."""
        status = await self._post("updateGameStatus", data="data")
        try:
            return {str(user["name"]) for user in json.loads(status["users"])}
        except (KeyError, TypeError, ValueError) as error:
            raise GameError(f"cannot understand the server's status: {error!r}") from None

    async def _post(self, call: str, **form: str) -> dict[str, Any]:
        """The JSON object that the server answers; GameError."""
        try:
            async with self._http.post(f"{self._url}/{call}", data=form) as response:
                answer = json.loads(await response.text())
        except (aiohttp.ClientError, TimeoutError, OSError, ValueError) as error:
            raise GameError(f"no game server at {self._url}: {error or type(error).__name__}") from None
        if not isinstance(answer, dict):
            raise GameError(f"{call}: the server's answer is not a JSON object")
        self._answered_at = asyncio.get_running_loop().time()
        return answer


class Rosbridge:
    """An open connection to rosbridge that may drive one robot: the session's cookie, sent with it, says who drives."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse, robot: int) -> None:
        self._socket = socket
        self._topic = command_topic(robot)
        self.status: Status | None = None

    async def start(self) -> None:
        """Ask for the battle's state and announce the commands."""
        await self._socket.send_json({"op": "subscribe", "topic": GAME_STATUS})
        await self._socket.send_json({"op": "advertise", "topic": self._topic, "type": "laser_bot_battle/Robot_msg"})

    async def follow(self) -> None:
        """Keep `status` new until the connection ends."""
        async for frame in self._socket:
            if frame.type is not aiohttp.WSMsgType.TEXT:
                continue
            try:
                message = json.loads(frame.data)
                if message.get("op") == "publish" and message.get("topic") == GAME_STATUS:
                    self.status = Status.from_message(message["msg"])
                elif message.get("op") == "status" and message.get("level") in {"error", "warning"}:
                    _log.warning("rosbridge: %s", message.get("msg"))
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                _log.warning("cannot understand a message from rosbridge: %r", error)

    async def command(self, command: Command) -> None:
        await self._socket.send_json(
            {
                "op": "publish",
                "topic": self._topic,
                "msg": {"linear_x": command.linear_x, "angular_z": command.angular_z, "shoot": command.shoot},
            }
        )


@dataclass(frozen=True)
class Arena:
    """What does not change in the arena."""

    width: float
    height: float
    walls: Sequence[Wall]


class Eyes:
    """Watches the arena's view."""

    def __init__(self, http: aiohttp.ClientSession, url: str) -> None:
        self._http = http
        self._url = url
        self._robots: dict[int, Pose] = {}
        self._seen_at = 0.0
        self.arena: Arena | None = None

    def robots(self) -> dict[int, Pose]:
        """Where the robots are now, by ID; empty when the arena does not answer."""
        return self._robots if self.can_see else {}

    @property
    def can_see(self) -> bool:
        """Whether the arena answers."""
        return asyncio.get_running_loop().time() - self._seen_at < BLIND_AFTER

    async def watch(self) -> NoReturn:
        """For ever, through restarts of the arena."""
        told = False
        while True:
            try:
                async with self._http.ws_connect(self._url, heartbeat=5) as socket:
                    _log.info("watching the arena at %s", self._url)
                    told = False
                    async for frame in socket:
                        if frame.type is aiohttp.WSMsgType.TEXT:
                            self._take(json.loads(frame.data))
            except (aiohttp.ClientError, TimeoutError, OSError, KeyError, TypeError, ValueError) as error:
                if not told:
                    _log.warning("the arena at %s does not answer: %s; standing still", self._url, error)
                told = True
            await asyncio.sleep(RETRY)

    def _take(self, message: Mapping[str, Any]) -> None:
        if message["type"] == "arena":
            walls = [(float(x1), float(y1), float(x2), float(y2)) for x1, y1, x2, y2 in message["walls"]]
            self.arena = Arena(float(message["width"]), float(message["height"]), walls)
        elif message["type"] == "state":
            self._robots = {
                int(robot["id"]): Pose(float(robot["x"]), float(robot["y"]), float(robot["heading"]))
                for robot in message["robots"]
                if robot["id"] is not None
            }
            self._seen_at = asyncio.get_running_loop().time()
