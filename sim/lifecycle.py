"""How the programs of sim run: until a signal, and with signs of life for health checks."""

import asyncio
import contextlib
import signal

from laser_bot_battle import alive


def signalled() -> asyncio.Event:
    """An event that SIGINT and SIGTERM set from now on."""
    event = asyncio.Event()
    for signum in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(signum, event.set)
    return event


async def live_until(end: asyncio.Event) -> None:
    """Return when `end` is set; until then, tell health checks that the event loop turns."""
    while not end.is_set():
        alive.touch()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(end.wait(), alive.PERIOD)
