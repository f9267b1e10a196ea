"""A program of others that one of ours runs, such as ustreamer or nginx, with a sign of life as long as both do."""

import asyncio
import logging
import signal
from collections.abc import Callable, Sequence
from pathlib import Path

from laser_bot_battle import alive

STOP_SECONDS = 2.0

_log = logging.getLogger(__name__)


def until_signalled() -> asyncio.Event:
    """Set by SIGINT or SIGTERM, for the running loop."""
    end = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, end.set)
    return end


async def run_child(
    command: Sequence[str | Path],
    end: asyncio.Event,
    look: Callable[[asyncio.subprocess.Process], None] = lambda child: None,
) -> int:
    """Run it until `end` is set (0), or until it ends by itself (1). `look` is called once a second meanwhile.

    It has a process group of its own: Ctrl-C reaches this program only, which then ends it.
    """
    child = await asyncio.create_subprocess_exec(*command, process_group=0)
    ended, ordered = asyncio.create_task(child.wait()), asyncio.create_task(end.wait())
    try:
        while not ended.done() and not ordered.done():
            alive.touch()
            look(child)
            await asyncio.wait([ended, ordered], timeout=alive.PERIOD, return_when=asyncio.FIRST_COMPLETED)
        if ordered.done():
            return 0
        name = Path(command[0]).name
        _log.error("%s has ended (%s): the program ends, for its supervisor to start it again", name, ended.result())
        return 1
    finally:
        ordered.cancel()
        await stop(child)
        ended.cancel()


async def stop(child: asyncio.subprocess.Process, within: float = STOP_SECONDS) -> None:
    """Ask it to end, and kill it after `within` s."""
    if child.returncode is not None:
        return
    child.terminate()
    try:
        await asyncio.wait_for(child.wait(), within)
    except TimeoutError:
        child.kill()
        await child.wait()
