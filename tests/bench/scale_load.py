"""Who loads the master that scale measures: players' pages and their sockets, each at a loopback address of its own.

The server has budgets by address. Nobody here is spared: a hundred players have a hundred addresses, as in a hall.
"""

import asyncio
import itertools
import json
import time
from typing import Any, NamedTuple

import aiohttp

from laser_bot_battle.msg import Robot_msg
from tests.bench.bench_spectators import Guests
from tests.bench.rosbridge_load import TYPE, paced
from tests.support.bare import text_of
from tests.support.light_robots import InLoop

BEAT = 2.0  # s between two signs of life of a page
BATTLE_WITHIN = 60.0  # s beyond the countdown

# What a player has keys for, but for the neutral command, which the master sends itself when it stops a robot: a
# command's place here is its number, modulo their count.
KEYS = [keys for keys in itertools.product((-1, 0, 1), (-1, 0, 1), (False, True)) if any(keys)]
NUMBER_OF = {bytes([linear & 0xFF, angular & 0xFF, shoot]): n for n, (linear, angular, shoot) in enumerate(KEYS)}


class Seat(NamedTuple):
    """A player who is signed in."""

    robot: int
    address: str
    cookie: str


def address(kind: int, number: int) -> str:
    """One of this machine's own, for players (kind 2) or spectators (3)."""
    return f"127.{kind}.{number // 250}.{number % 250 + 1}"


class Pages(InLoop):
    """The players' pages, as far as they speak HTTP: sign-up, being ready, signs of life."""

    def __init__(self, web: str) -> None:
        super().__init__()
        self._web = web
        self._sessions: list[aiohttp.ClientSession] = []

    def free(self) -> int:
        """How many robots the server would give away now."""
        return self.do(self._free())

    def sign_up(self, count: int) -> list[Seat]:
        """player0 and so on; RuntimeError when one gets no robot."""
        return self.do(self._sign_up(count))

    def battle(self) -> None:
        """All get ready. Returns when the battle runs; RuntimeError when somebody is not in it."""
        self.do(self._battle())

    def state(self) -> dict[str, Any]:
        """What the server says of the game now."""
        return self.do(self._post(self._sessions[0], "updateGameStatus"))

    async def _free(self) -> int:
        async with aiohttp.ClientSession() as session:
            return int((await self._post(session, "getAvailableRobots"))["availableR"])

    async def _sign_up(self, count: int) -> list[Seat]:
        seats = []
        for number in range(count):
            place = address(2, number)
            connector = aiohttp.TCPConnector(limit=1, local_addr=(place, 0))
            session = aiohttp.ClientSession(connector=connector, cookie_jar=aiohttp.CookieJar(unsafe=True))
            self._sessions.append(session)
            answer = await self._post(session, "signUpUser", data=f"player{number}")
            if answer["status"] != "OK":
                raise RuntimeError(f"player{number} cannot sign up: {answer}")
            cookie = "; ".join(f"{cookie.key}={cookie.value}" for cookie in session.cookie_jar)
            seats.append(Seat(answer["robot"], place, cookie))
            self.keep(self._beat(session))
        return seats

    async def _battle(self) -> None:
        for number, session in enumerate(self._sessions):
            answer = await self._post(session, "playerReady", user=f"player{number}", ready=1)
            if answer["status"] != "OK":
                raise RuntimeError(f"player{number} cannot get ready: {answer}")
        async with asyncio.timeout(BATTLE_WITHIN + countdown(len(self._sessions))):
            while (state := await self._post(self._sessions[0], "updateGameStatus"))["game"] != 2:
                await asyncio.sleep(0.2)
        fighters = [user["name"] for user in json.loads(state["users"]) if user["ready"]]
        if len(fighters) != len(self._sessions):
            raise RuntimeError(f"only {len(fighters)} are in the battle")

    async def _beat(self, session: aiohttp.ClientSession) -> None:
        while True:
            await asyncio.sleep(BEAT)
            await self._post(session, "updateGameStatus")

    async def _post(self, session: aiohttp.ClientSession, route: str, **fields: object) -> dict[str, Any]:
        data = {name: str(value) for name, value in fields.items()}
        async with session.post(f"{self._web}/{route}", data=data) as answer:
            return dict(json.loads(await answer.text()))

    async def leave(self) -> None:
        try:
            await super().leave()
        finally:
            for session in self._sessions:
                await session.close()


def countdown(players: int) -> int:
    """s in which they all can get ready, one after the other."""
    return 5 + players // 10


class Drivers(Guests):
    """The players' sockets: they drive, and hear each state of the battle."""

    def __init__(self, host: str, port: int) -> None:
        everything: dict[str, object] = {"op": "subscribe", "topic": "/game_status"}
        super().__init__(host, port, [everything])
        self._robots: list[int] = []

    def sit_down(self, seats: list[Seat]) -> None:
        self.come([(seat.address, seat.cookie) for seat in seats])
        self._robots = [seat.robot for seat in seats]
        for client, robot in zip(self._clients, self._robots, strict=True):
            client.say("advertise", topic=f"/Robot{robot}/command", type=TYPE)

    def drive(self, rate: float, seconds: float) -> dict[int, list[float]]:
        """Each at `rate` commands/s; by robot, when each command was sent (monotonic s)."""
        frames = [
            [
                text_of(
                    "publish",
                    topic=f"/Robot{robot}/command",
                    msg=dict(zip(Robot_msg.__slots__, keys, strict=True)),
                )
                for keys in KEYS
            ]
            for robot in self._robots
        ]
        sent: list[list[float]] = [[] for _ in self._robots]
        for message in paced(rate * len(self._robots), seconds):
            number, driver = divmod(message, len(self._robots))
            sent[driver].append(time.monotonic())
            self._clients[driver].send(frames[driver][number % len(KEYS)])
        return dict(zip(self._robots, sent, strict=True))
