"""Who works when in the event loop: what one client sends must not keep the others waiting."""

import asyncio
import time
from collections import deque
from typing import Protocol

# What all workers that are not urgent have together in one turn. One of them may take somewhat longer.
BUDGET = 0.003  # s


class Worker(Protocol):
    """Has data of a client to handle."""

    def work(self) -> bool:
        """Do as much as is fair in one turn; true when nothing is left."""

    def resume(self) -> None:
        """Nothing is left: more data may come."""


class Scheduler:
    """Of one event loop, for its thread only."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._waiting: deque[Worker] = deque()
        self._spent = 0.0  # s of the budget in this turn
        self._ending = False

    def run(self, worker: Worker, urgent: bool) -> bool:
        """Let it work now, if it is urgent or the turn's time is not used up; true when it has nothing left."""
        if urgent:
            return worker.work()
        self._begin()
        if self._waiting or self._spent >= BUDGET:
            return False
        return self._measured(worker)

    def wait(self, worker: Worker) -> None:
        """Let it go on in a later turn, and resume when nothing is left."""
        self._begin()
        self._waiting.append(worker)

    def _begin(self) -> None:
        """The budget of this turn counts until `_end`."""
        if not self._ending:
            self._ending = True
            self._loop.call_soon(self._end)

    def _measured(self, worker: Worker) -> bool:
        begin = time.perf_counter()
        try:
            return worker.work()
        finally:
            self._spent += time.perf_counter() - begin

    def _end(self) -> None:
        """The end of a turn: after all that the sockets had, and before they are asked again."""
        self._spent, self._ending = 0.0, False
        if not self._waiting:
            return
        self._begin()
        for _ in range(len(self._waiting)):
            worker = self._waiting.popleft()
            if self._measured(worker):
                worker.resume()
            else:
                self._waiting.append(worker)
            if self._spent >= BUDGET:
                break
