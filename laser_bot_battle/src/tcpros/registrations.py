"""What a node wants to be registered with the master, and what is: brought together call by call.

Wishes are coalesced: however often one changes, the master is asked at most once per turn of the queue, and another
topic's registration waits for few calls.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Literal

from laser_bot_battle.master import MasterError

_log = logging.getLogger(__name__)

FIRST_PAUSE, LONGEST_PAUSE = 0.5, 8.0  # s, when the master does not answer
# At the end, so many calls at a time.
AT_ONCE = 8

Key = tuple[str, str]


@dataclass(frozen=True, eq=False)
class Registration:
    """A wish. Each is one of its own: a topic that is left and taken again is registered again, which tells its peers
    to connect."""

    kind: Literal["Publisher", "Subscriber", "Service"]
    name: str
    what: str
    """the type of the topic, or the address of the service"""
    api: str
    """the URI of the node"""
    answered: Callable[[Any], Awaitable[None]] | None = None
    """called with the master's answer, before the next registration; an OSError has it registered once more"""

    @property
    def key(self) -> Key:
        return self.kind, self.name

    @property
    def undo(self) -> tuple[str, str, str]:
        return f"unregister{self.kind}", self.name, self.what if self.kind == "Service" else self.api


class Registrations:
    """`call(method, *arguments)` calls the master: OSError when it does not answer, MasterError when it refuses."""

    def __init__(self, call: Callable[..., Awaitable[Any]]) -> None:
        self._call = call
        self._wanted: dict[Key, Registration] = {}
        self._known: dict[Key, Registration] = {}  # to the master, or perhaps known to it
        self._settled: dict[Key, Registration] = {}  # known for certain
        self._dirty: dict[Key, None] = {}
        self._wake = asyncio.Event()
        self._worker: asyncio.Task[None] | None = None

    def start(self) -> None:
        self._worker = asyncio.get_running_loop().create_task(self._run())

    def want(self, registration: Registration) -> None:
        self._wanted[registration.key] = registration
        self._mark(registration.key)

    def drop(self, key: Key) -> None:
        if self._wanted.pop(key, None):
            self._mark(key)

    async def close(self, seconds: float) -> None:
        """Take all back, as far as the master answers within `seconds`."""
        self._wanted.clear()
        if self._worker:
            self._worker.cancel()
            await asyncio.gather(self._worker, return_exceptions=True)
        at_once = asyncio.Semaphore(AT_ONCE)

        async def undo(registration: Registration) -> None:
            async with at_once:
                await self._call(*registration.undo)

        if self._known:
            tasks = [asyncio.create_task(undo(registration)) for registration in self._known.values()]
            await asyncio.wait(tasks, timeout=seconds)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    def _mark(self, key: Key) -> None:
        self._dirty[key] = None
        self._wake.set()

    async def _run(self) -> None:
        pause = FIRST_PAUSE
        while True:
            if not self._dirty:
                self._wake.clear()
                await self._wake.wait()
            key = next(iter(self._dirty))
            del self._dirty[key]
            try:
                await self._settle(key)
            except OSError as error:
                self._dirty[key] = None
                if pause == FIRST_PAUSE:
                    _log.warning("the ROS master does not answer (%s): %s %s waits", error, *key)
                await asyncio.sleep(pause)
                pause = min(2 * pause, LONGEST_PAUSE)
            else:
                if pause != FIRST_PAUSE:
                    _log.info("the ROS master answers again")
                pause = FIRST_PAUSE

    async def _settle(self, key: Key) -> None:
        wanted, known = self._wanted.get(key), self._known.get(key)
        if wanted is self._settled.get(key) and (wanted or not known):
            return
        try:
            if wanted:
                self._settled.pop(key, None)
                self._known[key] = wanted
                answer = await self._call(f"register{wanted.kind}", wanted.name, wanted.what, wanted.api)
                if wanted.answered and self._wanted.get(key) is wanted:
                    await wanted.answered(answer)
                self._settled[key] = wanted
            elif known:
                self._settled.pop(key, None)
                await self._call(*known.undo)
                del self._known[key]
        except MasterError as error:
            _log.error("the ROS master refuses %s %s: %s", *key, error)
            if wanted:
                self._settled[key] = wanted
            else:
                del self._known[key]
