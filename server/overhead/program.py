"""The tracker at work, between the camera and ROS. For the event loop's thread."""

import asyncio
import logging
import struct
import time
from collections.abc import Iterable
from functools import partial
from typing import NoReturn

from prometheus_client.core import Metric
from std_msgs.msg import String

from laser_bot_battle.msg import OverheadCovered, OverheadStatus, OverheadView, Positions, Robot_msg
from laser_bot_battle.names import (
    OVERHEAD_CAMERA,
    OVERHEAD_COVERED,
    OVERHEAD_STATUS,
    OVERHEAD_VIEW,
    POSITIONS,
    command_topic,
)
from laser_bot_battle.watched import counter, gauge
from server.camera.budget import Meter
from server.overhead.eye import Eye, Looker, PictureError
from server.overhead.messages import TF, packed, positions, sight, transforms
from server.overhead.robots import Seen
from server.overhead.settings import Settings
from server.overhead.tracker import Tracker
from server.overhead.view import View, has_moved
from tcpros.node import Node
from tcpros.specs import TypeSpec

_log = logging.getLogger(__name__)

IDLE = 0.25  # s without a picture until places are told without one: covered robots, and then none
STATUS = 1.0  # s from one status to the next, at most
TICK = 0.1  # s
SAY_AGAIN = 60.0  # s until the log repeats a trouble
CAMERA = "camera"  # key of its troubles
_COMMAND = struct.Struct("<bbB")  # a serialized Robot_msg


class OverheadProgram:
    """Publishes where robots are, and follows what they are told."""

    def __init__(self, node: Node, settings: Settings, eye: Eye, looker: Looker) -> None:
        """Needs a running event loop."""
        self._loop = asyncio.get_running_loop()
        self._node, self._eye, self._looker = node, eye, looker
        self._floor, self._tag_height = settings.floor, settings.tag_height
        self._tracker = Tracker(settings.floor, settings.camera_height, settings.tag_height)
        self._positions = node.advertise(POSITIONS, TypeSpec.of(Positions), latest=True)
        self._tf = node.advertise("/tf", TF, latest=True)
        self._status = node.advertise(OVERHEAD_STATUS, TypeSpec.of(OverheadStatus), latch=True)
        self._sight = node.advertise(OVERHEAD_VIEW, TypeSpec.of(OverheadView), latch=True)
        self._covered = node.advertise(OVERHEAD_COVERED, TypeSpec.of(OverheadCovered), latch=True)
        self._told_covered: list[int] = []
        self._covered.publish(packed(OverheadCovered(self._told_covered)))
        self._view: View | None = None  # that was told
        self._sight.publish(sight(None, self._tag_height))
        node.advertise(OVERHEAD_CAMERA, TypeSpec.of(String), latch=True).publish(packed(String(eye.url)))
        self._followed: set[int] = set()  # robots whose commands are heard
        self._rate = Meter(self._loop.time())  # of pictures that were looked at
        self._looked = 0
        self._age = 0.0  # s, of the newest picture when its places were told
        self._told = float("-inf")  # when places were
        self._last_status: OverheadStatus | None = None
        self._status_sent = float("-inf")
        self._broken = ""  # what is wrong with the newest picture
        self._said: dict[object, float] = {}  # when the log had each trouble

    async def run(self) -> NoReturn:
        """Look at pictures until this is cancelled."""
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._eye.run())
                tasks.create_task(self._tick())
                while True:
                    await self._look()
        finally:  # it is latched, and others may tell places from now on
            self._tell_covered([])

    def metrics(self) -> Iterable[Metric]:
        """For those who watch the program."""
        now = self._loop.time()
        return [
            counter(
                "laserbot_overhead_pictures_total",
                "Pictures that came from the camera above the floor.",
                self._eye.pictures,
            ),
            counter("laserbot_overhead_looked_total", "Those of them that were searched for tags.", self._looked),
            gauge("laserbot_overhead_robots", "Robots that have a place.", len(self._tracker.robots(now))),
            gauge("laserbot_overhead_floor_tags", "Floor tags in the last picture.", len(self._tracker.floor_tags)),
            gauge(
                "laserbot_overhead_age_seconds", "Age of the last picture when the places in it were told.", self._age
            ),
        ]

    def missing(self) -> str:
        """Why robots have no places, "" if they can have."""
        if self._places():
            return ""
        return "; ".join(self._troubles(self._loop.time()).values()) or "no picture has come yet"

    async def _look(self) -> None:
        picture = await self._eye.newest()
        taken = self._loop.time() - max(0.0, time.time() - picture.taken)
        try:
            tags, size = await asyncio.to_thread(self._looker.tags, picture.jpeg)
        except PictureError as error:
            self._broken = str(error)
            return
        self._broken = ""
        self._looked += 1
        self._rate.add(1)
        self._tracker.see(tags, size, taken)
        self._tell_view()
        self._age = self._loop.time() - taken
        self._tell()

    async def _tick(self) -> NoReturn:
        while True:
            now = self._loop.time()
            self._rate.mark(now)
            if now - self._told >= IDLE:
                self._tell()
            await asyncio.sleep(TICK)

    def _tell(self) -> None:
        now = self._told = self._loop.time()
        robots = self._tracker.robots(now)
        self._tell_covered([seen.robot for seen in robots if seen.covered])
        if robots or self._places():  # silence says that nobody knows, and an empty floor that nobody is there
            self._positions.publish(positions(self._floor, robots))
        if robots:
            self._tf.publish(transforms(robots, time.time(), self._looked))
        for robot in {seen.robot for seen in robots} - self._followed:
            self._followed.add(robot)
            self._node.subscribe(command_topic(robot), TypeSpec.of(Robot_msg), partial(self._hear, robot))
        self._tell_status(robots, now)

    def _tell_covered(self, robots: list[int]) -> None:
        """Before their places, of which it says that they are predicted."""
        if robots != self._told_covered:
            self._told_covered = robots
            self._covered.publish(packed(OverheadCovered(robots)))

    def _tell_view(self) -> None:
        view = self._tracker.view
        if has_moved(self._view, view, self._floor):
            self._view = view
            self._sight.publish(sight(view, self._tag_height))

    def _tell_status(self, robots: list[Seen], now: float) -> None:
        troubles = self._troubles(now)
        self._log(troubles, now)
        status = OverheadStatus(
            troubles=list(troubles.values()),
            places=self._places(),
            rate=self._last_status.rate if self._last_status else 0.0,
            floor_tags=[] if CAMERA in troubles else self._tracker.floor_tags,
            robots=[seen.robot for seen in robots],
        )
        if status != self._last_status or now - self._status_sent >= STATUS:
            status.rate = round(self._rate.rate(now), 1)
            self._status.publish(packed(status))
            self._last_status, self._status_sent = status, now

    def _hear(self, robot: int, data: bytes, _: object) -> None:
        if len(data) == _COMMAND.size:
            linear_x, angular_z, _shoot = _COMMAND.unpack(data)
            self._tracker.command(robot, linear_x, angular_z, self._loop.time())

    def _places(self) -> bool:
        return self._tracker.view is not None and not self._eye.trouble and not self._broken

    def _troubles(self, now: float) -> dict[object, str]:
        trouble = self._eye.trouble or self._broken
        if trouble:
            return {CAMERA: f"no picture of the camera above the floor ({self._eye.url}): {trouble}"}
        return self._tracker.troubles(now)

    def _log(self, troubles: dict[object, str], now: float) -> None:
        """Each trouble once while it lasts, and what has happened."""
        for news in self._tracker.news():
            _log.info("%s", news)
        for key, text in troubles.items():
            if now - self._said.get(key, float("-inf")) >= SAY_AGAIN:
                self._said[key] = now
                _log.warning("%s", text)
