"""One camera, as long as somebody looks through it: found, connected to, and tried again when it is lost."""

import asyncio
import contextlib
import logging
import time
from collections.abc import Awaitable, Callable
from functools import partial

from laser_bot_battle.names import ABOVE, robot_node
from server.camera.budget import Meter
from server.camera.clock import ClockOffset
from server.camera.multipart import Part, StreamError
from server.camera.pace import Pace
from server.camera.picture import Picture, dated, full_rate_of, picture_of
from server.camera.stream import Address, follow
from server.camera.viewer import Viewer

_log = logging.getLogger(__name__)

LIVE, WAITING, NONE = "live", "waiting", "none"
RETRY = 1.0  # s from one attempt to the next


class _OtherRateError(Exception):
    """The viewers can show more pictures a second than this stream has, or only fewer."""


class Camera:
    """`state`, its `reason` for people, and the newest `picture`. For the event loop's thread, from the constructor on
    until `close`."""

    def __init__(
        self,
        robot: int,
        find: Callable[[], Awaitable[Address]],
        pictured: Callable[["Camera", Picture], None],
        changed: Callable[["Camera"], None],
    ) -> None:
        """That of a robot, or the one ABOVE. `find` tells where the camera is: LookupError when there is none,
        StreamError when that cannot be told. `pictured` is called with each picture, `changed` when the state has
        changed."""
        self._loop = asyncio.get_running_loop()
        self._find, self._pictured, self._changed = find, pictured, changed
        self.robot = robot
        self._name = "the camera above the floor" if robot == ABOVE else f"the camera of {robot_node(robot)}"
        self.viewers: set[Viewer] = set()
        self.state, self.reason = WAITING, "the camera is looked for"
        self.picture: Picture | None = None
        self._pace = Pace()
        self._number = 0
        self._rate = Meter(self._loop.time())  # of pictures
        self._task = self._loop.create_task(self._run())

    def close(self) -> None:
        """End the connection."""
        self._task.cancel()

    def add(self, viewer: Viewer) -> None:
        """One more looks through the camera."""
        self.viewers.add(viewer)
        self._pace.restart()

    def mark(self, now: float) -> None:
        """To be called now and then: rates are measured."""
        self._rate.mark(now)
        for viewer in self.viewers:
            viewer.mark(now)

    def metrics(self, now: float) -> dict[str, object]:
        """For operators."""
        picture = self.picture
        return {
            "robot": self.robot,
            "viewers": len(self.viewers),
            "rate": round(self._rate.rate(now), 1),
            "age": None if picture is None else round(max(0.0, time.time() - picture.taken), 3),
            "kilobytes": None if picture is None else round(len(picture.jpeg) / 1000, 1),
            "state": self.state,
        }

    async def _run(self) -> None:
        while True:
            began = self._loop.time()
            try:
                await self._look(await self._find())
            except LookupError:
                self._become(NONE)
            except StreamError as error:
                self._become(WAITING, str(error))
            except Exception:  # this camera's trouble, and nobody else's
                _log.exception("%s has failed", self._name)
                self._become(WAITING, "the relay has failed")
            self.picture = None
            await asyncio.sleep(began + RETRY - self._loop.time())

    async def _look(self, address: Address) -> None:
        """At the rate that the viewers can show: another one begins with the next picture, and viewers hear nothing of
        the change."""
        offset = ClockOffset()
        self._pace.restart()  # what is there now may be another camera
        while True:
            rate = self._pace.rate
            with contextlib.suppress(_OtherRateError):
                await follow(address.at(rate), partial(self._received, offset, rate))

    def _received(self, offset: ClockOffset, rate: int, part: Part) -> None:
        self._number += 1
        now = time.time()
        if self.robot == ABOVE:  # any program may send its pictures
            part = dated(part, now)
        picture = picture_of(part, self.robot, self._number, offset, now)
        self._rate.add(1)
        self.picture = picture
        if picture.online:
            self._become(LIVE)
        else:
            self._become(WAITING, "the camera is away")
        self._pictured(self, picture)
        self._judge(full_rate_of(part))
        if self._pace.rate != rate:
            raise _OtherRateError

    def _judge(self, full: int) -> None:
        now = self._loop.time()
        if not full:
            self._pace.restart()
        elif self.viewers:
            shown = max(viewer.rate(now) for viewer in self.viewers)
            complete = max(viewer.complete(now) for viewer in self.viewers)
            self._pace.judge(full, shown, complete, now)

    def _become(self, state: str, reason: str = "") -> None:
        if (state, reason) != (self.state, self.reason):
            self.state, self.reason = state, reason
            _log.info("%s: %s", self._name, f"{state}, {reason}" if reason else state)
            self._changed(self)
