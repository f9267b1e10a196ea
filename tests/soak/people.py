"""People of an evening: they come, wait for a robot, play, and go, some without a word."""

import asyncio
import contextlib
import json
import random
import time
from typing import Any

import aiohttp

from tests.support.light_robots import InLoop
from tests.support.player import Place

STAY = (20.0, 90.0)  # s
AWAY = (1.0, 10.0)  # s
POLITE = 0.7  # of them sign out
LOOK = 1.0  # s between two looks at the own seat
PERIOD = 0.05  # s between two commands
PATIENCE = aiohttp.ClientTimeout(total=5.0)

# What happens while a part of the master is away, or only slow.
GONE = (aiohttp.ClientError, OSError, TimeoutError, ValueError)


class Person:
    """At an address of its own; `chance` decides when it comes, goes and what it steers."""

    def __init__(self, number: int, place: Place, chance: random.Random) -> None:
        self.name = f"person{number}"
        self._address = f"127.2.0.{number + 1}"
        self._web, self._bridge = place.web, place.bridge
        self._chance = chance

    async def live(self) -> None:
        while True:
            connector = aiohttp.TCPConnector(local_addr=(self._address, 0))
            jar = aiohttp.CookieJar(unsafe=True)
            async with aiohttp.ClientSession(connector=connector, cookie_jar=jar, timeout=PATIENCE) as http:
                await self._visit(http, time.monotonic() + self._chance.uniform(*STAY))
            await asyncio.sleep(self._chance.uniform(*AWAY))

    async def _visit(self, http: aiohttp.ClientSession, end: float) -> None:
        signed_up = False
        while time.monotonic() < end:
            with contextlib.suppress(*GONE):
                seat = await self._seat(http)
                if seat["status"] == "UNREGISTERED" and not signed_up:
                    seat = await self._post(http, "signUpUser", data=self.name, wait=1)
                    signed_up = seat["status"] in ("OK", "QUEUED")
                if seat.get("offer") is not None:
                    seat = await self._post(http, "takeRobot")
                if seat["status"] == "OK":
                    await self._play(http, seat["robot"], end)
                elif signed_up and seat["status"] == "UNREGISTERED":
                    return  # the robot is gone, or the time on it
            await asyncio.sleep(LOOK)
        if self._chance.random() < POLITE:
            with contextlib.suppress(*GONE):
                await self._post(http, "signOutUser", data=self.name)

    async def _play(self, http: aiohttp.ClientSession, robot: int, end: float) -> None:
        """Until the seat is lost, or the connection."""
        async with http.ws_connect(self._bridge) as socket:
            topic = f"/Robot{robot}/command"
            await socket.send_json(
                {"op": "subscribe", "topic": "/game_status", "throttle_rate": 200, "queue_length": 1}
            )
            await socket.send_json({"op": "advertise", "topic": topic, "type": "laser_bot_battle/Robot_msg"})
            hearing = asyncio.ensure_future(self._hear(socket))
            try:
                look_at = 0.0
                while time.monotonic() < end and not hearing.done():
                    if time.monotonic() >= look_at:
                        look_at = time.monotonic() + LOOK
                        if (await self._seat(http)).get("robot") != robot:
                            return
                        await self._post(http, "playerReady", user=self.name, ready=1)
                    await socket.send_json({"op": "publish", "topic": topic, "msg": self._command()})
                    await asyncio.sleep(PERIOD)
            finally:
                hearing.cancel()

    @staticmethod
    async def _hear(socket: aiohttp.ClientWebSocketResponse) -> None:
        async for _ in socket:
            pass

    def _command(self) -> dict[str, object]:
        linear, angular = self._chance.choice((-1, 0, 1)), self._chance.choice((-1, 0, 1))
        return {"linear_x": linear, "angular_z": angular, "shoot": self._chance.random() < 0.5}

    async def _seat(self, http: aiohttp.ClientSession) -> dict[str, Any]:
        async with http.get(f"{self._web}/session") as answer:
            return dict(json.loads(await answer.text()))

    async def _post(self, http: aiohttp.ClientSession, route: str, **fields: object) -> dict[str, Any]:
        data = {name: str(value) for name, value in fields.items()}
        async with http.post(f"{self._web}/{route}", data=data) as answer:
            return dict(json.loads(await answer.text()))


class People(InLoop):
    """`count` of them, from now on."""

    def __init__(self, count: int, place: Place, seed: int) -> None:
        super().__init__()
        self._people = [Person(number, place, random.Random(f"{seed} {number}")) for number in range(count)]
        self.do(self._live())

    async def _live(self) -> None:
        for person in self._people:
            self.keep(person.live())
