"""What virtual robots' cameras cost: `python3 -m tests.bench.bench_cameras` prints their CPU time.

First the painter alone, in this process. Then a whole arena: robots drive, and some of their cameras are watched.
`age` is that of a picture when it has been read; `answer` is the time of the slowest twentieth of newcomers from their
hello to the light that falls on them, which no picture may delay.
"""

import argparse
import math
import random
import statistics
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import psutil

from sim.arena.ambient import Ambient
from sim.arena.cameras.picture import Painter
from sim.arena.cameras.scene import Body, Room, Scene
from tests.bench.bench_rosbridge import cpu_seconds
from tests.integration.sim.arena import Arena, Hardware
from tests.integration.sim.stream import Stream
from tests.support.floors import BATTLE_FLOOR
from tests.support.polling import until

PERIOD = 0.04  # s between two reports of a robot's wheels, as the firmware's simulator sends them
SPEED = 41  # half-steps in that time
SCENES = 200
EYES = (0, 1, 4, 7)
ROBOTS = 8


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


def picture_costs() -> list[tuple[float, float, int]]:
    """Of many scenes: ms of CPU for the picture, the same with its JPEG, and bytes of that."""
    painter = Painter(Room(BATTLE_FLOOR.width, BATTLE_FLOOR.height, BATTLE_FLOOR.walls, Ambient()))
    chance = random.Random(1)
    costs = []
    for count in range(-ROBOTS, SCENES):  # the first ones paint the robots' textures
        bodies = []
        for number in range(ROBOTS if count < 0 else 4):
            x, y, heading = chance.uniform(0.1, 1.5), chance.uniform(0.1, 1.1), chance.uniform(-3.14, 3.14)
            bodies.append(Body(f"virtual{number}", number, x, y, heading, chance.random() < 0.3, False, 0.5))
        scene = Scene("virtual0", 0.0, 0.0, tuple(bodies))
        start = time.process_time()
        painter.picture(scene)
        middle = time.process_time()
        size = len(painter.jpeg(scene))
        end = time.process_time()
        if count >= 0:
            costs.append(((middle - start) * 1e3, (end - middle) * 1e3, size))
    return costs


@contextmanager
def looking(arena: Arena, eyes: int) -> Iterator[list[float]]:
    """Somebody looks through so many robots' eyes meanwhile; the list gets the age (s) of each picture."""
    ages: list[float] = []
    streams = [Stream(arena, f"virtual{number}") for number in range(eyes)]

    def read(stream: Stream) -> None:
        while (part := stream.part()) is not None:
            ages.append(time.time() - float(part.headers["x-timestamp"]))

    readers = [threading.Thread(target=read, args=(stream,)) for stream in streams]
    for reader in readers:
        reader.start()
    try:
        yield ages
    finally:
        for stream in streams:
            stream.end()
        for reader in readers:
            reader.join()
        for stream in streams:
            stream.close()


def answers(arena: Arena, seconds: float) -> list[float]:
    """ms from each newcomer's hello to the light that falls on it."""
    delays = []
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        start = time.monotonic()
        with Hardware(arena, "guest") as guest:
            guest.line()
        delays.append((time.monotonic() - start) * 1e3)
        time.sleep(0.03)
    return delays


def measure(eyes: int, seconds: float) -> None:
    with ExitStack() as stack:
        arena = Arena()
        stack.callback(arena.program.stop)
        robots = [stack.enter_context(Hardware(arena, f"virtual{number}")) for number in range(max(4, eyes))]
        for robot in robots:
            robot.line()  # it is on the floor
        stack.enter_context(driving(robots))
        ages = stack.enter_context(looking(arena, eyes))
        until(lambda: len(ages) >= 20 * eyes, 60, "the first second")
        ages.clear()
        program = psutil.Process(arena.program.process.pid)
        painters = program.children()
        before = [cpu_seconds(process.pid) for process in (program, *painters)]
        delays = answers(arena, seconds)
        after = [cpu_seconds(process.pid) for process in (program, *painters)]
        count = len(ages)
        own, *painting = [(later - sooner) / seconds * 100 for sooner, later in zip(before, after, strict=True)]
        memory = sum(process.memory_info().rss for process in painters) / 2**20
        print(
            f"{eyes:5}{count / seconds / max(1, eyes):8.1f}{own:9.1f}{sum(painting):11.1f}"
            f"{sum(painting) / 100 * seconds / max(1, count) * 1e3:12.1f}{statistics.median(ages or [0]) * 1e3:8.1f}"
            f"{memory:6.0f}{statistics.quantiles(delays, n=20)[-1]:11.1f}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description="What virtual robots' eyes cost.")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each number of eyes")
    seconds = parser.parse_args().seconds
    pictures, jpegs, sizes = zip(*picture_costs(), strict=True)
    print(f"CPU of a picture: {statistics.median(pictures):.1f} ms, with its JPEG {statistics.median(jpegs):.1f} ms")
    print(f"a JPEG: {statistics.mean(sizes) / 1000:.1f} kB\n")
    print("eyes  each/s  arena %  painter %  picture ms  age ms   MiB  answer ms")
    for eyes in EYES:
        measure(eyes, seconds)


if __name__ == "__main__":
    main()
