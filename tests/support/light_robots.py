"""Robots as far as the master sees them: registered, on their topics, alive, and hit now and then.

They have no wheels and no serial line, and share an event loop: 128 of them cost little.
"""

import asyncio
import contextlib
import random
import threading
import time
import uuid
from collections.abc import Coroutine
from typing import Any, TypeVar

import aiohttp
import uvloop
from std_msgs.msg import Empty

from laser_bot_battle.lifecycle import first_of
from laser_bot_battle.master import MasterError
from laser_bot_battle.msg import Robot_msg
from laser_bot_battle.names import ADD_NEW_ROBOT, command_topic, response_topic, robot_node
from laser_bot_battle.srv import AddNewRobot
from tcpros.node import Node
from tcpros.specs import ServiceError, TypeSpec

PING = 0.4  # s
WATCH = 1.0  # s between two looks at the ROS master
ASK_AGAIN = 0.5  # s, after a registration that came to nothing
T = TypeVar("T")


async def _empty(_header: object) -> bytes:
    """The request for an ID."""
    return b""


class InLoop:
    """Work in an event loop of its own, in a thread: it goes on between the calls."""

    def __init__(self) -> None:
        self._loop = uvloop.new_event_loop()
        self._tasks: set[asyncio.Task[None]] = set()
        self._thread = threading.Thread(target=self._loop.run_forever)
        self._thread.start()

    def do(self, work: Coroutine[Any, Any, T]) -> T:
        """Have it done there, and wait for its result."""
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()

    def keep(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Have it go on, until its end or `close`. To be called in the loop."""
        task = self._loop.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    def close(self) -> None:
        """All ends, without a word. Raises what some of it has failed with."""
        try:
            self.do(self.leave())
        finally:
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
            self._loop.close()

    async def leave(self) -> None:
        """What `close` does in the loop."""
        for task in self._tasks:
            task.cancel()
        for result in await asyncio.gather(*self._tasks, return_exceptions=True):
            if isinstance(result, Exception):
                raise result


class LightRobot:
    """One robot; its life is the task `live`."""

    def __init__(self, name: str, master_uri: str, web: str) -> None:
        self.name = name
        self.id: int | None = None
        self.arrived: list[tuple[float, bytes]] = []  # commands: monotonic s, serialized
        self._master_uri, self._web = master_uri, web
        self._client = Node(f"/id_service_client_{name}", master_uri)
        self._hits: Any = None

    async def live(self) -> None:
        """Register, and work until server or ROS master have forgotten it; again and again."""
        while True:
            robot_id = await self._register()
            node = Node(robot_node(robot_id), self._master_uri)
            await node.start()
            node.subscribe(command_topic(robot_id), TypeSpec.of(Robot_msg), self._obey)
            self._hits = node.advertise(response_topic(robot_id), TypeSpec.of(Empty))
            self.id = robot_id
            try:
                await first_of(self._ping(robot_id), self._watch_master(node))
            finally:
                self.id = None
                await node.close()

    def take_hit(self) -> None:
        """Its sensor has seen light."""
        if self.id is not None:
            self._hits.publish(b"")

    def _obey(self, data: bytes, _header: object) -> None:
        self.arrived.append((time.monotonic(), data))

    async def _register(self) -> int:
        while True:
            with contextlib.suppress(ServiceError):
                answer, _ = await self._client.call(ADD_NEW_ROBOT, _empty, timeout=10.0, md5sum=AddNewRobot._md5sum)
                return int.from_bytes(answer, signed=True)
            await asyncio.sleep(ASK_AGAIN)

    async def _ping(self, robot_id: int) -> None:
        """Until the server does not know the robot."""
        async with aiohttp.ClientSession(connector=aiohttp.TCPConnector(limit=1)) as http:
            due = time.monotonic() + PING * random.random()
            while True:
                await asyncio.sleep(due - time.monotonic())
                due = max(due + PING, time.monotonic())
                with contextlib.suppress(aiohttp.ClientError, TimeoutError):
                    timeout = aiohttp.ClientTimeout(total=1.0)
                    async with http.post(f"{self._web}/incAlive", data={"ID": str(robot_id)}, timeout=timeout) as reply:
                        if '"ERROR"' in await reply.text():
                            return

    @staticmethod
    async def _watch_master(node: Node) -> None:
        """As the serial node does (laser_bot_battle.master.MasterWatch): until the master was restarted."""
        key, mark = f"{node.name}/alive_mark", uuid.uuid4().hex
        with contextlib.suppress(MasterError, OSError):
            await node.master("setParam", key, mark)
            while True:
                await asyncio.sleep(WATCH)
                with contextlib.suppress(OSError):
                    if await node.master("getParam", key) != mark:
                        return


class LightRobots(InLoop):
    """`count` robots, named light0 and so on."""

    def __init__(self, count: int, master_uri: str, web: str) -> None:
        super().__init__()
        self._robots = [LightRobot(f"light{number}", master_uri, web) for number in range(count)]
        self.do(self._live())

    def ids(self) -> list[int]:
        """Of those that are registered and on their topics."""
        return [robot.id for robot in self._robots if robot.id is not None]

    def fight(self, rate: float) -> None:
        """So many hits a second from now on, one robot after the other."""
        self.do(self._fight(rate))

    def collect(self) -> dict[int, list[tuple[float, bytes]]]:
        """The commands that came since the last call, by robot."""
        return self.do(self._collect())

    async def _live(self) -> None:
        for robot in self._robots:
            self.keep(robot.live())

    async def _fight(self, rate: float) -> None:
        self.keep(self._hit(1 / rate))

    async def _hit(self, period: float) -> None:
        while True:
            for robot in self._robots:
                await asyncio.sleep(period)
                robot.take_hit()

    async def _collect(self) -> dict[int, list[tuple[float, bytes]]]:
        collected = {robot.id: robot.arrived for robot in self._robots if robot.id is not None}
        for robot in self._robots:
            robot.arrived = []
        return collected
