"""Scheduler of the event loop: how soon they follow each other, and who works in them."""

import asyncio
import time
from unittest.mock import Mock

import pytest

from server.websocket.pace import BUSY_RATE, TURN, WINDOW, Pace
from server.websocket.scheduling import BUDGET, Scheduler


def rests(pace: Pace, rate: float, seconds: float = 1.0, work: float = 0.0001) -> list[float]:
    """How long each turn is followed by a rest when a message comes `rate` times a second; each turn takes `work`."""
    found, now, come = [], 0.0, 0
    while now < seconds:
        begin = max(now, come / rate)
        messages = int(begin * rate) + 1 - come
        come += messages
        found.append(pace.rest(begin, begin + work, messages))
        now = begin + work + found[-1]
    return found


def test_without_load_nothing_waits() -> None:
    assert set(rests(Pace(), BUSY_RATE * 0.9)) == {0.0}


@pytest.mark.parametrize("rate", [BUSY_RATE * 1.2, 4000, 20_000])
def test_under_load_turns_begin_some_time_after_each_other(rate: float) -> None:
    busy = rests(Pace(), rate, 10 * WINDOW)
    assert {round(rest, 6) for rest in busy[-100:]} == {round(TURN - 0.0001, 6)}


def test_a_turn_that_took_long_is_followed_by_the_next_at_once() -> None:
    assert set(rests(Pace(), 4000, work=TURN * 1.1)) == {0.0}


def test_the_load_ends() -> None:
    pace = Pace()
    rests(pace, 4000)
    assert pace.rest(10.0, 10.0, 1) == 0.0


class Busy:
    """Has so many pieces of work, each of which takes so long; writes into `log` when it works."""

    def __init__(self, name: str, pieces: int, seconds: float, log: list[str]) -> None:
        self.name, self.pieces, self.seconds, self.log = name, pieces, seconds, log
        self.resumed = asyncio.Event()

    def work(self) -> bool:
        begin = time.perf_counter()
        while time.perf_counter() - begin < self.seconds:
            pass
        self.pieces -= 1
        self.log.append(self.name)
        return self.pieces == 0

    def resume(self) -> None:
        self.log.append(f"{self.name} resumes")
        self.resumed.set()


def test_those_who_wait_take_turns_and_the_urgent_do_not_wait() -> None:
    log: list[str] = []

    async def share() -> None:
        scheduler = Scheduler(asyncio.get_running_loop())
        one, two = Busy("one", 3, BUDGET, log), Busy("two", 2, BUDGET, log)
        assert not scheduler.run(one, urgent=False)
        scheduler.wait(one)
        assert not scheduler.run(two, urgent=False), "the turn's time is used up"
        scheduler.wait(two)
        assert scheduler.run(Busy("urgent", 1, 0, log), urgent=True)
        async with asyncio.timeout(5):
            await one.resumed.wait()
            await two.resumed.wait()
        late = Busy("late", 1, 0, log)
        async with asyncio.timeout(5):
            while not scheduler.run(late, urgent=False):
                await asyncio.sleep(0)

    asyncio.run(share())
    assert log == ["one", "urgent", "one", "two", "one", "one resumes", "two", "two resumes", "late"]


def ends(messages: int) -> list[bool]:
    """Which turns end, over three windows, when each of an urgent worker's handles so many messages."""
    loop, urgent, found = Mock(), Busy("urgent", 1, 0, []), []
    scheduler = Scheduler(loop)
    until = time.monotonic() + 3 * WINDOW
    while time.monotonic() < until:
        loop.reset_mock()
        scheduler.run(urgent, urgent=True)
        scheduler.handled += messages
        for call in loop.call_soon.call_args_list:
            call.args[0]()
        found.append(loop.call_soon.called)
    return found


def test_without_load_hardly_any_turn_costs_an_end() -> None:
    assert 1 <= sum(ends(messages=0)) <= 4


def test_under_load_every_turn_ends() -> None:
    assert all(ends(messages=100)[-10:])
