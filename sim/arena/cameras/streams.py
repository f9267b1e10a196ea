"""The viewers of each eye: pictures are painted for them, and for nobody else."""

import asyncio
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, NoReturn

from laser_bot_battle.geometry import free_distance
from sim.arena.cameras.painter_process import PainterError, PainterProcess, painter_process
from sim.arena.cameras.scene import Body, Scene
from sim.arena.light import BEAM_RANGE
from sim.arena.world import Robot, World

LINGER = 5.0  # s without anybody who looks until the process that paints is ended
RETRY = 0.5  # s from the end of one such process to the next

_log = logging.getLogger(__name__)


class Picture(NamedTuple):
    taken: float  # Unix time in s
    jpeg: bytes


@dataclass(eq=False)
class Eye:
    """An eye while somebody looks through it: the newest picture, and a bell for the next one."""

    rates: list[int] = field(default_factory=list)  # pictures/s that each who looks wants
    picture: Picture | None = None
    closed: bool = False  # the robot has left, or the arena ends
    _progress: int = 0  # grows by the rate in each of the painter's turns; at the full rate, a picture is due
    _bell: asyncio.Event = field(default_factory=asyncio.Event)

    async def after(self, last: Picture | None) -> Picture | None:
        """The newest picture as soon as that is not `last`; None when there will be no more."""
        while self.picture is last and not self.closed:
            await self._bell.wait()
        return None if self.closed else self.picture

    def is_due(self, full: int) -> bool:
        """Whether a picture is painted now. To be called once in each of the painter's turns, which are `full` a
        second."""
        self._progress += max(self.rates)
        if self.picture and self._progress < full:
            return False
        self._progress = max(0, self._progress - full)
        return True

    def show(self, picture: Picture) -> None:
        self.picture = picture
        self._ring()

    def close(self) -> None:
        self.closed = True
        self._ring()

    def _ring(self) -> None:
        self._bell.set()
        self._bell = asyncio.Event()


class Streams:
    """The eyes that somebody looks through. For the event loop's thread."""

    def __init__(
        self, painter: str, room: bytes, rate: int, scene: Callable[[str, float, float], Scene | None]
    ) -> None:
        """`painter` is the module of a process that gets `room` and then scenes, at most `rate` a second of each eye.
        `scene` has the eye's name, the time of the arena's clock and Unix time, both in s, and returns None once
        there is no such eye."""
        self._painter, self._room, self.rate, self._scene = painter, room, rate, scene
        self._eyes: dict[str, Eye] = {}
        self._wanted = asyncio.Event()
        self._lookers = 0

    @property
    def lookers(self) -> int:
        return self._lookers

    def open(self, name: str, rate: int) -> Eye:
        """One more looks through the eye `name`, until `leave` is called, and wants `rate` pictures/s. It gets more
        while somebody else wants more."""
        eye = self._eyes.setdefault(name, Eye())
        eye.rates.append(rate)
        self._lookers += 1
        self._wanted.set()
        return eye

    def leave(self, name: str, eye: Eye, rate: int) -> None:
        eye.rates.remove(rate)
        self._lookers -= 1
        if not eye.rates and self._eyes.get(name) is eye:
            del self._eyes[name]
        if not self._eyes:
            self._wanted.clear()

    def close(self) -> None:
        """Everybody has seen the last picture."""
        for eye in self._eyes.values():
            eye.close()

    async def paint_for_ever(self) -> NoReturn:
        """Whenever somebody looks."""
        while True:
            await self._wanted.wait()
            try:
                async with painter_process(self._painter, self._room) as painters:
                    await self._paint(painters)
            except PainterError as error:
                _log.warning("%s, which paints pictures, is started again: %s", self._painter, error)
                await asyncio.sleep(RETRY)

    async def _paint(self, painters: PainterProcess) -> None:
        """Until nobody has looked for some time."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        while await self._is_wanted():
            for name, eye in [item for item in self._eyes.items() if item[1].is_due(self.rate)]:
                scene = self._scene(name, loop.time(), time.time())
                if scene:
                    eye.show(Picture(scene.taken, await painters.paint(scene)))
                else:
                    del self._eyes[name]
                    eye.close()
            if not self._eyes:
                self._wanted.clear()
            due = max(due + 1 / self.rate, loop.time())  # pictures for which there was no time are left out
            await asyncio.sleep(due - loop.time())

    async def _is_wanted(self) -> bool:
        try:
            async with asyncio.timeout(LINGER):
                await self._wanted.wait()
        except TimeoutError:
            return False
        return True


def scene_of(world: World, eye: str, now: float, taken: float) -> Scene:
    """The world as `eye` sees it at `now` (s of the arena's clock), which is `taken` in Unix time."""
    robots = tuple(_body(world, robot, now) for robot in world.robots.values())
    return Scene(eye, now, taken, robots)


def _body(world: World, robot: Robot, now: float) -> Body:
    shines = robot.is_shining(now)
    pose = robot.pose
    others = [other.pose.point for other in world.robots.values() if other is not robot]
    return Body(
        name=robot.name,
        id=robot.id,
        x=pose.x,
        y=pose.y,
        heading=pose.heading,
        beam=shines,
        lit=robot.is_lit(now),
        reach=free_distance(pose.emitter, pose.heading, world.floor.walls, others, BEAM_RANGE) if shines else 0.0,
    )
