"""Work whose time grows with a message is done outside the event loop, so that no command waits for it."""

import asyncio
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context, parent_process
from typing import Any, cast

from laser_bot_battle import priority

_NICE = 10
_PART = 2**20  # bytes that are taken over at once

_made = [b""]  # in the process: what it has made last


class Outside:
    """A process of its own, which is started when there is something to do. One thing is done after the other."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._turn = asyncio.Lock()

    async def make(self, work: Callable[..., bytes], *arguments: Any) -> bytes:
        """The result of that function, or its exception. RuntimeError when the process has died of it."""
        async with self._turn:
            pool, loop = await self._started(), asyncio.get_running_loop()
            try:
                # taken over in parts: the whole at once would keep this program's other threads waiting
                made = bytearray(await loop.run_in_executor(pool, _make, work, *arguments))
                for at in range(0, len(made), _PART):
                    made[at : at + _PART] = await loop.run_in_executor(pool, _part, at)
            except BrokenProcessPool as error:
                self._pool = None
                raise RuntimeError("the process for large messages has died; the next one starts another") from error
            return cast(bytes, made)  # nobody changes it any more

    def close(self) -> None:
        """What is under way is not waited for."""
        if self._pool is not None:
            for process in list(self._pool._processes.values()):
                process.kill()
            self._pool.shutdown(wait=False, cancel_futures=True)

    async def _started(self) -> ProcessPoolExecutor:
        if self._pool is None:
            pool = ProcessPoolExecutor(1, get_context("spawn"), _begin)
            with ThreadPoolExecutor(1) as starter:
                await asyncio.get_running_loop().run_in_executor(starter, _start, pool)
            self._pool = pool
        return self._pool


def _start(pool: ProcessPoolExecutor) -> None:
    """In a thread of its own: a process has the priority of the thread that starts it."""
    priority.give_back_here()
    pool.submit(os.getpid).result()


def _make(work: Callable[..., bytes], *arguments: Any) -> int:
    """In the process: how many bytes there are."""
    _made[0] = work(*arguments)
    return len(_made[0])


def _part(at: int) -> bytes:
    return _made[0][at : at + _PART]


def _begin() -> None:
    """In the new process."""
    os.nice(_NICE)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # sent to the whole program, which ends us
    threading.Thread(target=_end_with_the_program, daemon=True).start()


def _end_with_the_program() -> None:
    program = parent_process()
    if program is not None:
        program.join()
    os._exit(0)
