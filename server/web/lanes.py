"""Who is served next. What a battle lives on never waits for what people look at, nor one address for another.

Each lane has threads of its own. Within a lane the addresses take turns, a request each, and none has more than RATE
turns a second: who asks a thousand times waits for himself. A player who is refused has had REFUSED turns: who guesses
waits longer.
"""

import logging
import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Mapping
from enum import Enum, auto
from typing import Protocol

from laser_bot_battle.token_bucket import TokenBuckets

_log = logging.getLogger(__name__)


class Lane(Enum):
    ROBOTS = auto()  # their signs of life
    PLAYERS = auto()  # log-in, ready, status, and what operators decide
    LISTS = auto()  # what people look at and only the game knows
    PAGES = auto()  # all else that people look at


RATE, BURST = 50, 200  # requests/s of one address in a lane: a hall may share one; and at once
REFUSED = 10  # turns
THREADS = {Lane.ROBOTS: 2, Lane.PLAYERS: 3, Lane.LISTS: 2, Lane.PAGES: 4}


class Task(Protocol):
    """What waitress wants done."""

    def service(self) -> None: ...

    def cancel(self) -> None: ...


class Lanes:
    """A dispatcher of waitress. `place` says which lane a task is in, and whose it is; None's turns are not counted."""

    def __init__(self, place: Callable[[Task], tuple[Lane, str | None]], threads: Mapping[Lane, int] = THREADS) -> None:
        self._place = place
        self._queues = {lane: _Queue() for lane in threads}
        self._threads = [
            threading.Thread(target=self._work, args=[self._queues[lane]], name=f"web {lane.name.lower()}", daemon=True)
            for lane, count in threads.items()
            for _ in range(count)
        ]
        for thread in self._threads:
            thread.start()

    def add_task(self, task: Task) -> None:
        lane, owner = self._place(task)
        self._queues[lane].put(task, owner)

    def refused(self, lane: Lane, owner: str | None) -> None:
        """That is what became of a request of this owner. It counts where people guess: a robot does not pay for what
        others do at its address, nor anybody for a page that is not there."""
        if owner is not None and lane is Lane.PLAYERS:
            self._queues[lane].charge(owner, REFUSED - 1)

    def shutdown(self, cancel_pending: bool = True, timeout: float = 5) -> bool:
        """End the threads. What waits is cancelled; whether anything did."""
        waiting = [task for queue in self._queues.values() for task in queue.close()]
        if cancel_pending:
            for task in waiting:
                task.cancel()
        return bool(waiting)

    def _work(self, queue: "_Queue") -> None:
        while (task := queue.get()) is not None:
            try:
                task.service()
            except Exception:
                _log.exception("a request failed")


class _Queue:
    """Tasks by owner; the owner whose turn was longest ago comes first."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: OrderedDict[str | None, deque[Task]] = OrderedDict()
        self._turns = TokenBuckets(BURST, 1 / RATE)
        self._is_closed = False

    def put(self, task: Task, owner: str | None) -> None:
        with self._changed:
            self._waiting.setdefault(owner, deque()).append(task)
            self._changed.notify()

    def get(self) -> Task | None:
        """The next one, as soon as there is one; None at the end."""
        with self._changed:
            while not self._is_closed:
                now = time.monotonic()
                soonest = None
                for owner, tasks in self._waiting.items():
                    pause = 0.0 if owner is None else self._turns.take(owner, now)
                    if not pause:
                        return self._take(owner, tasks)
                    soonest = pause if soonest is None else min(pause, soonest)
                self._changed.wait(soonest)
            return None

    def charge(self, owner: str, turns: int) -> None:
        self._turns.charge(owner, turns, time.monotonic())

    def close(self) -> list[Task]:
        """No more; what waits."""
        with self._changed:
            left = [task for tasks in self._waiting.values() for task in tasks]
            self._waiting.clear()
            self._is_closed = True
            self._changed.notify_all()
            return left

    def _take(self, owner: str | None, tasks: deque[Task]) -> Task:
        task = tasks.popleft()
        if tasks:
            self._waiting.move_to_end(owner)
        else:
            del self._waiting[owner]
        return task
