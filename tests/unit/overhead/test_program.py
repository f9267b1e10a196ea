"""The tracker's program, with pictures that need no camera and a node that needs no ROS."""

import asyncio
import time
from contextlib import suppress
from typing import Any, cast

from laser_bot_battle.apriltag import Detection
from laser_bot_battle.msg import OverheadCovered, Positions
from laser_bot_battle.names import OVERHEAD_COVERED, POSITIONS
from server.camera.picture import Picture
from server.overhead.eye import Eye, Looker
from server.overhead.program import OverheadProgram
from server.overhead.settings import Settings
from server.overhead.view import Size
from tcpros.node import Node
from tests.support.overhead_camera import SIZE, Floor, OverheadCamera

CAMERA = OverheadCamera(floor=Floor(1.6, 1.2), x=0.8, y=0.6, z=2.4, focal_length=1.6)
SETTINGS = {
    "LASERBOT_OVERHEAD_CAMERA": "http://127.0.0.1:9",
    "LASERBOT_OVERHEAD_HEIGHT": "2.4",
    "LASERBOT_FLOOR": "battle",
}


class Topic:
    """What is published on it."""

    def __init__(self) -> None:
        self._told: asyncio.Queue[bytes] = asyncio.Queue()
        self.publish = self._told.put_nowait

    async def hear(self, kind: type[Any]) -> list[Any]:
        """The robots of the next message."""
        async with asyncio.timeout(20):
            return list(kind().deserialize(await self._told.get()).robots)


class Hall:
    """A camera, who finds tags in its pictures, and who hears what is told of them."""

    url, trouble, pictures = "http://camera", "", 0

    def __init__(self) -> None:
        self.robots = {1: (0.3, 0.4, 0.5), 2: (1.3, 0.9, -2.0)}
        self.topics: dict[str, Topic] = {}

    async def run(self) -> None:
        await asyncio.Event().wait()

    async def newest(self) -> Picture:
        await asyncio.sleep(1 / 30)
        return Picture(255, 1, time.time(), True, b"")

    def tags(self, _jpeg: bytes) -> tuple[list[Detection], Size]:
        return CAMERA.floor_tags() + CAMERA.robots(self.robots), SIZE

    def advertise(self, topic: str, *_: Any, **__: Any) -> Topic:
        return self.topics.setdefault(topic, Topic())

    def subscribe(self, *_: Any) -> None:
        """Nobody tells robots to move."""


def test_who_stops_looking_says_that_nobody_is_covered() -> None:
    async def story() -> None:
        hall = Hall()
        program = OverheadProgram(cast(Node, hall), Settings.from_env(SETTINGS), cast(Eye, hall), cast(Looker, hall))
        covered = hall.topics[OVERHEAD_COVERED]
        assert await covered.hear(OverheadCovered) == []
        work = asyncio.create_task(program.run())
        while len(await hall.topics[POSITIONS].hear(Positions)) < 2:
            pass
        del hall.robots[1]
        assert await covered.hear(OverheadCovered) == [1]
        work.cancel()
        with suppress(asyncio.CancelledError):
            await work
        assert await covered.hear(OverheadCovered) == []

    asyncio.run(story())
