"""How well the camera above the floor finds robots: `python3 -m tests.bench.bench_overhead` prints errors, ages, CPU.

First the tracker alone, in simulated time: 8 robots drive at full speed, and whenever the next picture comes, their
places are held against the truth. `paint` and `find` are the CPU time of a picture in the arena and in the tracker.
Then the tracker's program with a ROS master and an arena: `age` is that of a picture when its places are told. Last,
what it costs the tracker and the cameras' relay that pages lay that picture under the robots they draw.
"""

import argparse
import asyncio
import json
import random
import statistics
import tempfile
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple, Self

import psutil
import requests
import websockets

from laser_bot_battle.floor import Floor
from laser_bot_battle.msg import GameStatus
from laser_bot_battle.names import ABOVE, WATCHED
from sim.arena.overhead.conditions import Conditions
from tests.bench.bench_cameras import driving
from tests.bench.bench_rosbridge import cpu_seconds
from tests.integration.rosbridge.ends import RosSide
from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.floors import BATTLE_FLOOR, DUEL_FLOOR
from tests.support.overhead import Hall
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

ROBOTS = 8
FIRST = 0.5  # s in which the tracker finds its way
HALL = Floor.of(4, 2.25, (), tuple((0.5 + 0.75 * column, 0.7 * row) for column in range(4) for row in (1, 2)))
WORST = Conditions(height=4, tilt=15, lens=-0.3, noise=10, exposure=0.03, shade=0.5, foot=0.1, print=0.98)
HALLS = {
    "battle": (BATTLE_FLOOR, Conditions()),
    "battle, worst": (BATTLE_FLOOR, WORST),
    "duel, crowd": (DUEL_FLOOR, Conditions()),
    "4 m x 2.25 m": (HALL, Conditions(height=3)),
    "the same, worst": (HALL, WORST),
}
AGE = "laserbot_overhead_age_seconds "
PICTURES = "laserbot_overhead_looked_total "
LOOKERS = (0, 1, 10)
PACE = 0.2  # s from one picture to the next, as pages ask for them
TICK = 0.05  # s


def measure_errors(name: str, floor: Floor, conditions: Conditions, seconds: float) -> None:
    hall = Hall(floor, ROBOTS, conditions)
    distances, angles, lost, looks = [], [], 0, 0
    painting, finding = [], []
    for _ in hall.play(seconds, random.Random(1)):
        if hall.now > FIRST:
            misses = hall.misses().values()
            distances += [miss.distance * 1e3 for miss in misses]
            angles += [miss.angle for miss in misses]
            lost += ROBOTS - len(misses)
            looks += ROBOTS
        painting.append(hall.painting * 1e3)
        finding.append(hall.finding * 1e3)
    across, turned = statistics.quantiles(distances, n=100), statistics.quantiles(angles, n=100)
    print(
        f"{name:18}{across[49]:8.1f}{across[94]:8.1f}{max(distances):8.1f}{turned[94]:10.2f}{max(angles):8.2f}"
        f"{lost / looks * 100:8.1f}{statistics.mean(painting):10.1f}{statistics.mean(finding):9.1f}",
        flush=True,
    )


def figure(port: int, name: str) -> float:
    """Of the tracker's program."""
    lines = requests.get(f"http://{HOST}:{port}/metrics", timeout=5).text.splitlines()
    return next((float(line.removeprefix(name)) for line in lines if line.startswith(name)), 0.0)


class Work(NamedTuple):
    """Of the tracker's program."""

    rate: float  # pictures looked at, each second
    ages: list[float]  # ms, of the newest picture when its places were told, again and again
    tracker: float  # cores that it takes
    painter: float  # that the arena takes to paint


def work_of_program(conditions: Conditions, seconds: float) -> Work:
    with ExitStack() as stack:
        tracker, port, painter, _ = started(stack, conditions)
        before = [cpu_seconds(pid) for pid in (tracker, painter)]
        first, began = figure(port, PICTURES), time.monotonic()
        ages = []
        while time.monotonic() < began + seconds:
            ages.append(figure(port, AGE) * 1e3)
            time.sleep(TICK)
        passed = time.monotonic() - began
        rate = (figure(port, PICTURES) - first) / passed
        after = [cpu_seconds(pid) for pid in (tracker, painter)]
        own, painting = [(later - sooner) / passed for sooner, later in zip(before, after, strict=True)]
        return Work(rate, ages, own, painting)


def measure_program(conditions: Conditions, seconds: float) -> None:
    rate, ages, own, painting = work_of_program(conditions, seconds)
    cuts = statistics.quantiles(ages, n=100)
    print(
        f"{rate:8.1f}{cuts[49]:9.1f}{cuts[94]:8.1f}{max(ages):8.1f}{own * 100:12.1f}{painting * 100:11.1f}", flush=True
    )


class Lookers:
    """Pages that ask the relay for the pictures from above, as often as those of the game."""

    def __init__(self, port: int, number: int) -> None:
        self.pictures = self.size = 0  # bytes
        self._url, self._number = f"ws://{HOST}:{port}", number
        self._over = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._look()))

    def __enter__(self) -> Self:
        self._thread.start()
        until(lambda: self.pictures >= self._number, 10, "pictures")
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    async def _look(self) -> None:
        pages = [asyncio.create_task(self._page()) for _ in range(self._number)]
        while not self._over.is_set():
            await asyncio.sleep(TICK)
        for page in pages:
            page.cancel()
        await asyncio.gather(*pages, return_exceptions=True)

    async def _page(self) -> None:
        async with websockets.connect(self._url, max_size=None) as socket:
            await socket.send(json.dumps({"op": "watch", "robot": ABOVE}))
            async for message in socket:
                if isinstance(message, bytes):
                    self.pictures, self.size = self.pictures + 1, self.size + len(message)
                    await asyncio.sleep(PACE)
                    await socket.send(json.dumps({"op": "seen"}))


def measure_lookers(seconds: float) -> None:
    with ExitStack() as stack:
        tracker, _, _, master = started(stack, Conditions())
        port = free_port()
        relay = Program.python("server.camera", env={**master.env, "LASERBOT_RELAY_PORT": str(port)})
        stack.callback(relay.stop)
        relay.wait_for("listening")
        referee = RosSide(master.env)
        stack.callback(referee.close)
        referee.status(GameStatus.STOPPED)  # until then, only operators see anything
        for number in LOOKERS:
            with Lookers(port, number) as lookers:
                pids = (tracker, relay.process.pid)
                before, first, began = [cpu_seconds(pid) for pid in pids], lookers.pictures, time.monotonic()
                size = lookers.size
                time.sleep(seconds)
                passed = time.monotonic() - began
                own, relaying = [
                    (cpu_seconds(pid) - sooner) / passed * 100 for pid, sooner in zip(pids, before, strict=True)
                ]
                rate = (lookers.pictures - first) / passed / max(1, number)
                sent = (lookers.size - size) * 8 / passed / 1e6
                print(f"{number:7}{rate:9.1f}{own:12.1f}{relaying:9.1f}{sent:9.1f}", flush=True)


def started(stack: ExitStack, conditions: Conditions) -> tuple[int, int, int, RosMaster]:
    """Robots that drive below a camera, and the tracker: its process, the port of its figures, the process that paints,
    and the ROS master."""
    master = RosMaster(Path(stack.enter_context(tempfile.TemporaryDirectory())))
    master.start()
    stack.callback(master.stop)
    arena = Arena(*conditions.options.split())
    stack.callback(arena.program.stop)
    robots = [stack.enter_context(Hardware(arena, f"virtual{number}")) for number in range(ROBOTS)]
    for robot in robots:
        robot.line()  # it is on the floor
    port = free_port()
    tracker = Program.python(
        "server.overhead",
        env={
            **master.env,
            "LASERBOT_OVERHEAD_CAMERA": f"{arena.page}overhead/stream",
            "LASERBOT_OVERHEAD_HEIGHT": f"{conditions.height:g}",
            "LASERBOT_METRICS": f"{HOST}:{port - WATCHED.index('overhead')}",
        },
    )
    stack.callback(tracker.stop)
    tracker.wait_for("the floor is known by")
    until(lambda: figure(port, PICTURES) >= 30, 30, "two seconds of pictures")
    stack.enter_context(driving(robots))
    (painter,) = psutil.Process(arena.program.process.pid).children()
    return tracker.process.pid, port, painter.pid, master


def main() -> None:
    parser = argparse.ArgumentParser(description="How well a camera above the floor finds robots.")
    parser.add_argument("--seconds", type=float, default=20.0, help="of each measurement")
    seconds = parser.parse_args().seconds
    print("floor              p50 mm  p95 mm  max mm   p95 deg max deg  lost %  paint ms  find ms")
    for name, (floor, conditions) in HALLS.items():
        measure_errors(name, floor, conditions, seconds)
    print("\n  each/s  age p50     p95  max ms  tracker %  painter %")
    for conditions in (Conditions(), WORST):
        measure_program(conditions, seconds)
    print("\nlookers  each/s   tracker %  relay %   Mbit/s")
    measure_lookers(seconds)


if __name__ == "__main__":
    main()
