"""Scheduler of the event loop: who works in its turns."""

import asyncio
import time

from server.websocket.scheduling import BUDGET, Scheduler


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
