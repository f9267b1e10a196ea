"""`python3 -m sim.positions`: tells ROS where the virtual robots are, as an overhead camera would: `/positions`.

It only watches the arena's public view.
"""

import argparse
import asyncio
import io
import json
import logging
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

import aiohttp

from laser_bot_battle.geometry import Pose, Wall
from laser_bot_battle.lifecycle import first_of, live_until, signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.master import Master, MasterWatch
from laser_bot_battle.msg import Positions, RobotPosition
from laser_bot_battle.names import POSITIONS, POSITIONS_NODE
from laser_bot_battle.ros_environment import ros_environment
from laser_bot_battle.settings import describe, read_or_exit
from laser_bot_battle.variables import ALIVE_FILE, ARENA, LOG_LEVEL, ROS_MASTER_URI
from tcpros.node import Node
from tcpros.publisher import Publisher
from tcpros.specs import TypeSpec

VARIABLES = (ROS_MASTER_URI, ARENA, LOG_LEVEL, ALIVE_FILE)
SPEC = TypeSpec.of(Positions)
PERIOD = 1 / 15  # s between two messages: pages draw what moves from them
BLIND_AFTER = 1.0  # s without a state of the arena
RETRY = 1.0  # s between attempts to connect to it

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Floor:
    """What does not change in the arena."""

    width: float
    height: float
    walls: Sequence[Wall]


class Eyes:
    """Watches the arena's public view."""

    def __init__(self, http: aiohttp.ClientSession, url: str) -> None:
        self._http = http
        self._url = url
        self._robots: dict[int, Pose] = {}
        self._seen_at = 0.0
        self.floor: Floor | None = None

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
                    _log.warning("the arena at %s does not answer: %s", self._url, error)
                told = True
            await asyncio.sleep(RETRY)

    def _take(self, message: Mapping[str, Any]) -> None:
        if message["type"] == "arena":
            walls = [(float(x1), float(y1), float(x2), float(y2)) for x1, y1, x2, y2 in message["walls"]]
            self.floor = Floor(float(message["width"]), float(message["height"]), walls)
        elif message["type"] == "state":
            self._robots = {
                int(robot["id"]): Pose(float(robot["x"]), float(robot["y"]), float(robot["heading"]))
                for robot in message["robots"]
                if robot["id"] is not None
            }
            self._seen_at = asyncio.get_running_loop().time()


def to_message(floor: Floor, robots: Mapping[int, Pose]) -> bytes:
    """A Positions, serialized."""
    message = Positions(
        width=floor.width,
        height=floor.height,
        walls=[number for wall in floor.walls for number in wall],
        robots=[RobotPosition(number, pose.x, pose.y, pose.heading) for number, pose in robots.items()],
    )
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


async def publish(eyes: Eyes, publisher: Publisher) -> NoReturn:
    """For ever, while the arena can be seen and somebody listens."""
    while True:
        if eyes.floor and eyes.can_see and publisher.connections:
            publisher.publish(to_message(eyes.floor, eyes.robots()))
        await asyncio.sleep(PERIOD)


async def tell(eyes: Eyes, master_uri: str, environment: Mapping[str, str]) -> None:
    """Publish until the master has lost this node, as after a restart. OSError if it cannot be reached."""
    loop, lost = asyncio.get_running_loop(), asyncio.Event()

    def on_lost(reason: str) -> None:
        _log.warning("%s", reason)
        loop.call_soon_threadsafe(lost.set)

    watch = MasterWatch(Master(master_uri, POSITIONS_NODE), on_lost)
    await asyncio.to_thread(watch.start)
    node = Node(POSITIONS_NODE, master_uri)
    node.on_shutdown = on_lost
    try:
        os.environ.update(ros_environment(environment, master_uri))
        await node.start()
        await first_of(publish(eyes, node.advertise(POSITIONS, SPEC, latest=True)), lost.wait())
    finally:
        watch.stop()
        await node.close()


async def tell_for_ever(eyes: Eyes, master_uri: str) -> NoReturn:
    """Also while there is no master, and when another one comes."""
    environment, told = dict(os.environ), ""  # this machine may have another address then
    while True:
        try:
            await tell(eyes, master_uri, environment)
        except OSError as error:
            if str(error) != told:
                _log.warning("no ROS master at %s: %s; waiting", master_uri, error)
            told = str(error)
        await asyncio.sleep(RETRY)


async def run(master_uri: str, view: str) -> None:
    """Work until SIGINT or SIGTERM."""
    end = signalled()
    async with aiohttp.ClientSession() as http:
        eyes = Eyes(http, view)
        await first_of(eyes.watch(), tell_for_ever(eyes, master_uri), live_until(end))


def read_settings(env: Mapping[str, str]) -> tuple[str, int, str]:
    """The ROS master's URI, the port of the arena's view, and how much is logged. SettingsError for a wrong value."""
    return ROS_MASTER_URI.read(env), ARENA.read(env), LOG_LEVEL.read(env)


def main() -> int:
    """Exit code 0 after a signal, 2 for an impossible setting."""
    parser = argparse.ArgumentParser(
        "sim.positions",
        description="Tells ROS where the virtual robots are.",
        epilog=describe(*VARIABLES),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--arena", metavar="HOST:PORT", help="the arena's view (default: on this machine)")
    arguments = parser.parse_args()
    master_uri, port, log_level = read_or_exit("positions", read_settings)
    configure_logging(log_level)
    asyncio.run(run(master_uri, f"ws://{arguments.arena or f'127.0.0.1:{port}'}/view"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
