"""How well the camera above the floor finds robots: `python3 -m tests.bench.bench_overhead` prints errors, ages, CPU.

First the tracker alone, in simulated time: 8 robots drive at full speed, and whenever the next picture comes, their
places are held against the truth. `paint` and `find` are the CPU time of a picture in the arena and in the tracker.
Then the tracker's program with a ROS master and an arena: `age` is that of a picture when its places are told.
"""

import argparse
import random
import statistics
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

import psutil
import requests

from laser_bot_battle.floor import Floor
from laser_bot_battle.names import WATCHED
from sim.arena.overhead.conditions import Conditions
from tests.bench.bench_cameras import driving
from tests.bench.bench_rosbridge import cpu_seconds
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


def measure_program(conditions: Conditions, seconds: float) -> None:
    with ExitStack() as stack:
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
        before = [cpu_seconds(pid) for pid in (tracker.process.pid, painter.pid)]
        first, began, ages = figure(port, PICTURES), time.monotonic(), []
        while time.monotonic() < began + seconds:
            ages.append(figure(port, AGE) * 1e3)
            time.sleep(0.05)
        passed = time.monotonic() - began
        rate = (figure(port, PICTURES) - first) / passed
        after = [cpu_seconds(pid) for pid in (tracker.process.pid, painter.pid)]
        own, painting = [(later - sooner) / passed * 100 for sooner, later in zip(before, after, strict=True)]
        cuts = statistics.quantiles(ages, n=100)
        print(f"{rate:8.1f}{cuts[49]:9.1f}{cuts[94]:8.1f}{max(ages):8.1f}{own:12.1f}{painting:11.1f}", flush=True)


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


if __name__ == "__main__":
    main()
