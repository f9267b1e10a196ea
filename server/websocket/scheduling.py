"""Who works when in the event loop: what one client sends must not keep the others waiting."""

import asyncio
import time
from collections import deque
from typing import Protocol

from server.websocket.pace import WINDOW, Pace

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
        self.handled = 0  # messages since the last turn that ended; who handles them counts them
        self._loop = loop
        self._pace = Pace()
        self._waiting: deque[Worker] = deque()
        self._spent = 0.0  # s of the budget in this turn
        self._began = 0.0
        self._ending = False

    def touch(self) -> None:
        """Something has come. Without load, now and then a turn that ends is enough to notice that load begins."""
        if self._pace.busy or time.monotonic() - self._began >= WINDOW:
            self._begin()

    def run(self, worker: Worker, urgent: bool) -> bool:
        """Let it work now, if it is urgent or the turn's time is not used up; true when it has nothing left."""
        if urgent:
            self.touch()
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
        """This is a turn that ends."""
        if not self._ending:
            self._ending, self._began = True, time.monotonic()
            self._loop.call_soon(self._end)

    def _measured(self, worker: Worker) -> bool:
        begin = time.perf_counter()
        try:
            return worker.work()
        finally:
            self._spent += time.perf_counter() - begin

    def _end(self) -> None:
        """The end of a turn: after all that the sockets had, and before they are asked again."""
        now = time.monotonic()
        rest = self._pace.rest(self._began, now, self.handled)
        self._spent, self.handled = 0.0, 0
        if not self._waiting:
            self._ending = False
            if rest:
                time.sleep(rest)  # on purpose: whatever could interrupt it is what shall wait
            return
        self._began = now
        self._loop.call_soon(self._end)
        for _ in range(len(self._waiting)):
            worker = self._waiting.popleft()
            if self._measured(worker):
                worker.resume()
            else:
                self._waiting.append(worker)
            if self._spent >= BUDGET:
                break
