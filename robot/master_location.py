"""Where this robot's master is: found before each life of the robot, and looked for again while it is lost."""

import asyncio
import concurrent.futures
import contextlib
import logging
import os
import threading
import time
from collections.abc import Callable, Coroutine
from typing import Any

from laser_bot_battle.addresses import lan_choice, own_addresses
from laser_bot_battle.place import Place, find_again, locate
from laser_bot_battle.ros_environment import address_towards, has_address
from robot.settings import Settings

END_TIMEOUT = 1.0  # s
LOOK = 1.0  # s between two looks at this robot's addresses

_log = logging.getLogger(__name__)


class MovedError(Exception):
    """The arena is at another place now."""

    def __init__(self, place: Place) -> None:
        super().__init__(f"{place}")
        self.place = place


class ReaddressedError(Exception):
    """This robot has another address now; the text says so."""


class MasterLocation:
    """The master's place over all lives of the robot. A robot that has joined an arena keeps to its name."""

    def __init__(self, settings: Settings) -> None:
        self._arena = settings.arena
        self._place: Place | None = None
        self._joined = False  # an arena that announces itself

    def locate(self) -> Place:
        """Where the robot goes now; NoArenaError says why it cannot go anywhere."""
        last, self._place = self._place, None
        with SearchThread(lambda: locate(os.environ, self._arena)) as search:
            self._place = search.outcome.result()
        if self._place != last:
            _log.info("%s", self._place)
        return self._place

    def join(self, place: Place) -> None:
        """The robot is registered there."""
        self._place = place
        if place.arena:
            self._arena, self._joined = place.arena, True

    def rest(self, seconds: float) -> None:
        """Wait before the next attempt, not longer than until the robot's arena is heard at a new place."""
        if self._joined:
            with SearchThread(lambda: find_again(self._arena, self._place)) as search:
                concurrent.futures.wait([search.outcome], seconds)
        else:
            time.sleep(seconds)


def locate_once(settings: Settings) -> Place:
    """For a program that is started by hand: where the master is, looked for and told if nobody has said it.

    NoArenaError says why it cannot be found.
    """
    if settings.place:
        return settings.place
    place = asyncio.run(locate(os.environ, settings.arena))
    _log.info("%s", place)
    return place


class OwnAddress:
    """This robot's address towards the master, by which ROS finds it: as its nodes read it when they start."""

    def __init__(self, place: Place) -> None:
        self._uri = place.ros_master_uri
        self._told = "" if has_address(os.environ) else self._now()
        self._due = 0.0
        if self._told:
            _log.info(
                "ROS finds this robot at %s; its networks: %s (LASERBOT_INTERFACE chooses)", self._told, lan_choice()
            )

    def check(self) -> None:
        """ReaddressedError when this robot has another one in its place."""
        if not self._told or time.monotonic() < self._due:
            return
        self._due = time.monotonic() + LOOK
        if self._told not in own_addresses() and (now := self._now()):
            raise ReaddressedError(f"ROS was told the address {self._told}, and this robot now has {now}")

    def _now(self) -> str:
        with contextlib.suppress(OSError):  # there is no network now
            return address_towards(self._uri)
        return ""


class Lookout:
    """Sees when master or robot have another address: it looks for an arena at a new place while its master is lost.

    A context manager that ends it.
    """

    def __init__(self, place: Place) -> None:
        self._place = place
        self._own = OwnAddress(place)
        self._search: SearchThread | None = None

    def __enter__(self) -> "Lookout":
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def watch(self, lost: bool) -> None:
        """Call it again and again. `lost`: the master does not answer. MovedError when its arena is elsewhere,
        ReaddressedError when this robot has another address."""
        self._own.check()
        if not self._place.arena:
            return  # where it is was said by people
        if not lost:
            self._stop()
        elif self._search is None:
            _log.info("looking for arena %r at another address", self._place.arena)
            place = self._place
            self._search = SearchThread(lambda: find_again(place.arena, place))
            self._search.start()
        elif self._search.outcome.done():
            raise MovedError(self._search.outcome.result())

    def _stop(self) -> None:
        if self._search:
            self._search.stop()
            self._search = None


class SearchThread(threading.Thread):
    """A search in a thread with an event loop of its own: a KeyboardInterrupt in the loop would leave tasks half done.

    A context manager that starts and ends it.
    """

    def __init__(self, search: Callable[[], Coroutine[Any, Any, Place]]) -> None:
        super().__init__(name="search", daemon=True)
        self.outcome: concurrent.futures.Future[Place] = concurrent.futures.Future()
        self._search = search
        self._task: asyncio.Task[Any] | None = None
        self._ends = False

    def __enter__(self) -> "SearchThread":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def run(self) -> None:
        try:
            self.outcome.set_result(asyncio.run(self._until_stopped()))
        except BaseException as error:  # the one who waits for the outcome hears it
            self.outcome.set_exception(error)

    async def _until_stopped(self) -> Place:
        self._task = asyncio.current_task()
        if self._ends:
            raise asyncio.CancelledError
        return await self._search()

    def stop(self) -> None:
        self._ends = True
        if self._task:
            with contextlib.suppress(RuntimeError):  # it has ended, and closed its loop
                self._task.get_loop().call_soon_threadsafe(self._task.cancel)
        self.join(END_TIMEOUT)
