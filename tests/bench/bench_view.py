"""What viewers of the arena cost: `python3 -m tests.bench.bench_view` prints the arena's CPU time and what viewers get.

Eight robots drive. The viewers are one process of their own: one drives, all others say that they watch, as the arena's
page does. CPU time is that of the whole arena; `per state` is of one state to one viewer.
"""

import argparse
import asyncio
import math
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import aiohttp

from sim.arena.viewers import DRIVE, WATCH
from sim.arena.world import MAX_ROBOTS
from tests.bench.bench_rosbridge import cpu_seconds
from tests.bench.rosbridge_load import Remote
from tests.integration.sim.arena import Arena, Hardware

CROWDS = (0, 1, 64, 200, 500)
PERIOD = 0.04  # s between two reports of a robot's wheels, as the firmware's simulator sends them
SPEED = 41  # half-steps in that time


class Crowd:
    """Viewers that read as fast as they can; the first one drives."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._loop = asyncio.new_event_loop()
        self._counts: list[int] = []
        self._tasks: list[asyncio.Task[None]] = []

    def come(self, viewers: int) -> None:
        """So many begin to look; returns when all have seen something."""
        self._counts = [0] * viewers
        self._loop.run_until_complete(self._come(viewers))

    def count(self, seconds: float) -> tuple[float, float]:
        """States a second that the driver gets, and each of the others on average."""
        before = list(self._counts)
        self._loop.run_until_complete(asyncio.sleep(seconds))
        rates = [(now - then) / seconds for now, then in zip(self._counts, before, strict=True)]
        return rates[0] if rates else 0.0, sum(rates[1:]) / max(1, len(rates) - 1)

    def leave(self) -> None:
        self._loop.run_until_complete(self._leave())

    def close(self) -> None:
        self._loop.close()

    async def _come(self, viewers: int) -> None:
        self._tasks = [asyncio.create_task(self._view(number)) for number in range(viewers)]
        async with asyncio.timeout(30):
            while not all(self._counts):
                await asyncio.sleep(0.05)

    async def _leave(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _view(self, number: int) -> None:
        async with aiohttp.ClientSession() as http, http.ws_connect(self._url) as socket:
            await socket.send_str(WATCH if number else DRIVE)
            async for _ in socket:
                self._counts[number] += 1


@contextmanager
def driving(robots: list[Hardware]) -> Iterator[None]:
    """The robots drive in curves meanwhile."""
    end = threading.Event()

    def drive() -> None:
        for turn in range(1_000_000):
            for number, robot in enumerate(robots):
                bend = 0.6 * math.sin(turn / 30 + number)
                robot.left -= int(SPEED * (1 - bend))
                robot.right += int(SPEED * (1 + bend))
                robot.send(f"wheels {robot.left} {robot.right}")
            if end.wait(PERIOD):
                return

    driver = threading.Thread(target=drive)
    driver.start()
    try:
        yield
    finally:
        end.set()
        driver.join()


def main() -> None:
    parser = argparse.ArgumentParser(description="What viewers of the arena cost.")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each crowd")
    seconds = parser.parse_args().seconds
    with ExitStack() as stack:
        arena = Arena()
        stack.callback(arena.program.stop)
        robots = [stack.enter_context(Hardware(arena, f"virtual{number}")) for number in range(MAX_ROBOTS)]
        stack.enter_context(driving(robots))
        crowd = Remote(Crowd, arena.view_url)
        stack.callback(crowd.close)
        print(f"{'viewers':>8}{'CPU %':>8}{'driver /s':>11}{'others /s':>11}{'per state us':>14}")
        idle = 0.0
        for viewers in CROWDS:
            crowd.call("come", viewers)
            before = cpu_seconds(arena.program.process.pid)
            drives, watches = crowd.call("count", seconds)
            cpu = (cpu_seconds(arena.program.process.pid) - before) / seconds
            crowd.call("leave")
            if not viewers:
                idle = cpu
            states = drives + watches * max(0, viewers - 1)
            each = (cpu - idle) / states * 1e6 if states else 0.0
            print(f"{viewers:8}{cpu * 100:8.1f}{drives:11.1f}{watches:11.1f}{each:14.0f}", flush=True)


if __name__ == "__main__":
    main()
