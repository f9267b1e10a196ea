"""Who loads the web server that bench_web measures: HTTP of pages and robots in one process, ROS in another."""

import asyncio
import time
from collections.abc import Sequence
from typing import NamedTuple

import aiohttp
import rospy
from std_msgs.msg import Empty

from laser_bot_battle.msg import Robot_msg
from laser_bot_battle.srv import AddNewRobot

# as Chromium and requests send them
BROWSER = {
    "User-Agent": "Mozilla/5.0 (X11; Linux x86_64) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/140.0.0.0",
    "Accept": "*/*",
    "Accept-Language": "en-GB,en;q=0.9",
    "Referer": "http://127.0.0.1/home",
    "Sec-Fetch-Mode": "cors",
    "Sec-Fetch-Site": "same-origin",
}
ROBOT = {"User-Agent": "python-requests/2.32.3", "Accept": "*/*", "Accept-Encoding": "gzip, deflate"}


class Times(NamedTuple):
    """Of one kind of request, in s."""

    latencies: list[float]
    duration: float


class Fleet:
    """Robots as far as ROS sees them: registered, with their topics."""

    def __init__(self) -> None:
        rospy.init_node("bench_fleet", anonymous=True)

    def register(self, count: int) -> list[int]:
        """The IDs of so many robots."""
        rospy.wait_for_service("/add_new_robot", 30)
        register = rospy.ServiceProxy("/add_new_robot", AddNewRobot)
        robots = [register().ID for _ in range(count)]
        self._topics = [
            topic
            for robot in robots
            for topic in (
                rospy.Subscriber(f"/Robot{robot}/command", Robot_msg),
                rospy.Publisher(f"/Robot{robot}/response", Empty, queue_size=1),
            )
        ]
        return robots

    def close(self) -> None:
        rospy.signal_shutdown("the end")


class Visitors:
    """Every page and every robot has one connection, which stays open."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._runner = asyncio.Runner()
        self._pages: list[aiohttp.ClientSession] = []
        self._robots: list[tuple[aiohttp.ClientSession, int]] = []

    def add_robots(self, robots: Sequence[int]) -> None:
        self._robots = [(self._runner.run(self._session(ROBOT)), robot) for robot in robots]

    def add_pages(self, count: int) -> None:
        """Each with a player who is ready."""
        self._runner.run(self._add_pages(count))

    def load(self, seconds: float, page_period: float, robot_period: float) -> dict[str, Times]:
        """What each kind of request took; a period of 0: the next request follows the answer."""
        return self._runner.run(self._load(seconds, page_period, robot_period))

    def close(self) -> None:
        for session in [*self._pages, *(session for session, _ in self._robots)]:
            self._runner.run(session.close())
        self._runner.close()

    async def _session(self, headers: dict[str, str]) -> aiohttp.ClientSession:
        jar = aiohttp.CookieJar(unsafe=True)  # of an address, not of a name
        return aiohttp.ClientSession(headers=headers, cookie_jar=jar, connector=aiohttp.TCPConnector(limit=1))

    async def _post(self, session: aiohttp.ClientSession, route: str, **fields: object) -> str:
        data = {name: str(value) for name, value in fields.items()}
        async with session.post(f"{self._url}/{route}", data=data) as answer:
            return await answer.text()

    async def _add_pages(self, count: int) -> None:
        end = time.monotonic() + 60
        for number in range(count):
            session, name = await self._session(BROWSER), f"player{number}"
            self._pages.append(session)
            while '"OK"' not in await self._post(session, "signUpUser", data=name):
                await self._ping_all()
                if time.monotonic() > end:
                    raise TimeoutError(f"no robot for {name}")
                await asyncio.sleep(0.2)
        for number, session in enumerate(self._pages):
            await self._post(session, "playerReady", user=f"player{number}", ready=1)
            await self._ping_all()

    async def _ping_all(self) -> None:
        for session, robot in self._robots:
            await self._post(session, "incAlive", ID=robot)

    async def _load(self, seconds: float, page_period: float, robot_period: float) -> dict[str, Times]:
        found: dict[str, list[float]] = {"updateGameStatus": [], "incAlive": []}
        begin = time.monotonic()

        async def visit(session: aiohttp.ClientSession, route: str, period: float, phase: float, value: object) -> None:
            due = begin + phase * period
            field = {"updateGameStatus": "data", "incAlive": "ID"}[route]
            while due < begin + seconds:
                await asyncio.sleep(due - time.monotonic())
                sent = time.monotonic()
                answer = await self._post(session, route, **{field: value})
                found[route].append(time.monotonic() - sent)
                if '"OK"' not in answer:
                    raise RuntimeError(f"{route}: {answer}")
                due = max(due + period, time.monotonic())

        async with asyncio.TaskGroup() as group:
            for place, session in enumerate(self._pages):
                phase = place / len(self._pages)
                group.create_task(visit(session, "updateGameStatus", page_period, phase, "data"))
            for place, (session, robot) in enumerate(self._robots):
                group.create_task(visit(session, "incAlive", robot_period, place / len(self._robots), robot))
        duration = time.monotonic() - begin
        return {route: Times(times, duration) for route, times in found.items()}
