"""How programs whose work is asyncio run: until a signal, and with signs of life for health checks."""

import asyncio
import contextlib
import signal
from collections.abc import Coroutine
from typing import Any, TypeVar

from laser_bot_battle import alive

T = TypeVar("T")


def signalled() -> asyncio.Event:
    """An event that SIGINT and SIGTERM set from now on."""
    event = asyncio.Event()
    for signum in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(signum, event.set)
    return event


async def first_of(*works: Coroutine[Any, Any, T]) -> T:
    """Do all at once until one ends or fails; the others are cancelled, and its result or exception is this one's.

    A TaskGroup would do the same, but with Python before 3.11.4 no time-out works any more in a task whose group was
    left by an exception.
    """
    tasks = [asyncio.ensure_future(work) for work in works]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        return next(iter(done)).result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def live_until(end: asyncio.Event) -> None:
    """Return when `end` is set; until then, tell health checks that the event loop turns."""
    while not end.is_set():
        alive.touch()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(end.wait(), alive.PERIOD)
