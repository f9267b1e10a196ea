"""How many players one master carries: `python3 -m tests.bench.scale` prints a row for each number of them.

The real master (ROS master, game server, rosbridge: a process each), light robots, as many drivers at 40 commands/s in
a battle that runs, and 200 spectators. All people have addresses of their own, and no budget of the server is changed.
What loads the master works on the same machine: its CPU time is a column, too.
"""

import argparse
import contextlib
import os
import signal
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import psutil

from laser_bot_battle.open_files import allow_files
from tests.bench.bench_rosbridge import Figures, cpu_seconds, figures_of
from tests.bench.bench_spectators import Guests, page_subscriptions
from tests.bench.rosbridge_load import Remote
from tests.bench.scale_load import KEYS, NUMBER_OF, Drivers, Pages, address, countdown
from tests.support.light_robots import LightRobots
from tests.support.polling import competitors, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import HOST, RosMaster

PLAYERS = (8, 32, 64, 100, 128)
SPECTATORS = 200
RATE = 40  # commands/s of each driver
HITS = 10  # a second, in a fierce battle
SECONDS = 20.0
WARM_UP = 2.0  # s
SETTLE = 1.0  # s, for what is on its way
FILES = 4096  # that each process may open
TOKEN = "the operators' token"

# what must hold for 100 drivers on 2 cores
P99 = 0.05  # s
CORES = 1.5


class Costs(NamedTuple):
    """Of one process."""

    cpu: float  # cores
    memory: int  # bytes


class Row(NamedTuple):
    """Of one number of players."""

    players: int
    costs: Mapping[str, Costs]  # of the master's processes, by name
    load: float  # cores, of all that loads the master
    figures: Figures

    @property
    def master(self) -> float:
        """cores"""
        return sum(each.cpu for each in self.costs.values())

    @property
    def p99(self) -> float:
        """s"""
        return statistics.quantiles(self.figures.latencies, n=100)[98]

    @property
    def faults(self) -> list[str]:
        """What the goal does not allow."""
        faults = []
        if self.p99 > P99:
            faults.append(f"p99 is over {P99 * 1e3:.0f} ms")
        if self.master > CORES:
            faults.append(f"the master needs more than {CORES} cores")
        if self.figures.lost:
            faults.append("commands are lost")
        return faults


class Master:
    """The three processes of a master, at free ports; `pids` by name."""

    def __init__(self, folder: Path, players: int, stack: contextlib.ExitStack) -> None:
        ros = RosMaster(folder)
        stack.callback(ros.stop)
        ros.start()
        self.uri, self.bridge_port, web = ros.uri, free_port(), free_port()
        self.web = f"http://{HOST}:{web}"
        os.environ.update(ros.env)  # of the programs here, and of what loads them
        settings = {
            **ros.env,
            "LASERBOT_BIND": HOST,
            "LASERBOT_WEB_PORT": str(web),
            "LASERBOT_ROSBRIDGE_PORT": str(self.bridge_port),
            "LASERBOT_DATA": str(folder / "data"),
            "LASERBOT_COUNTDOWN": str(countdown(players)),
            "LASERBOT_BATTLE_LIMIT": "3600",
            "LASERBOT_HIT_DAMAGE": "1",
            "LASERBOT_OPERATOR_TOKEN": TOKEN,
        }
        programs = {}
        for module, sign in (("server.main", "serving the game"), ("server.rosbridge", "listening on")):
            programs[module] = Program.python(module, env=settings)
            stack.callback(programs[module].stop)
            programs[module].wait_for(sign, 60)
        self.pids = {"rosmaster": ros.pid, **{name: program.process.pid for name, program in programs.items()}}


def main() -> None:
    arguments = parse_arguments()
    # a shell starts background programs with SIGINT ignored, and so would be what is started and stopped by SIGINT here
    signal.signal(signal.SIGINT, signal.default_int_handler)
    allow_files(FILES)
    print(
        f"{arguments.spectators} spectators, {arguments.rate:g} commands/s of a driver, {HITS} hits/s, "
        f"{arguments.seconds:g} s each"
    )
    header, *names = "", "rosmaster", "server.main", "server.rosbridge"
    print(f"{header:8}" + "".join(f"{name:>18}" for name in names) + f"{'master':>9}{'load':>7}{'command':>15}")
    print(
        f"{'players':>8}"
        + f"{'cores':>9}{'MiB':>9}" * len(names)
        + f"{'cores':>9}{'cores':>7}{'p50 ms':>9}{'p99 ms':>9}"
        f"{'lost':>16}{'loadavg before':>16}",
        flush=True,
    )
    bend = ""
    for players in arguments.players:
        busy = os.getloadavg()[0]
        with loaded_master(players, arguments.spectators) as loaded:
            row = measure(loaded, players, arguments.seconds, arguments.rate)
            show(row, busy)
        if row.faults and not bend:
            bend = f"It bends at {players} players: {', '.join(row.faults)}."
    print(bend or f"It does not bend up to {max(arguments.players)} players.")
    if competitors() > 1:
        print("Other programs had work for this machine's cores: on a quiet one, these figures are better.")


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="How many players one master carries.")
    parser.add_argument("--players", type=int, nargs="+", default=PLAYERS, help="numbers of drivers, each with a robot")
    parser.add_argument("--spectators", type=int, default=SPECTATORS)
    parser.add_argument(
        "--rate", type=float, default=RATE, help="commands/s; an arena has 128 IDs, more drivers are a higher rate"
    )
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each row, 60 at most: players are hit")
    return parser.parse_args()


class Loaded(NamedTuple):
    """A master in a battle, and what loads it."""

    master: Master
    robots: Remote
    pages: Remote
    drivers: Remote
    watching: Remote
    loads: list[Remote]


@contextlib.contextmanager
def loaded_master(
    players: int, spectators: int, prepare: Callable[[Path], None] = lambda folder: None
) -> Iterator[Loaded]:
    """`prepare` gets the master's folder before it starts."""
    with tempfile.TemporaryDirectory(prefix="laserbot-scale-") as folder, contextlib.ExitStack() as stack:
        prepare(Path(folder))
        master = Master(Path(folder), players, stack)
        robots = Remote(LightRobots, players, master.uri, master.web)
        pages = Remote(Pages, master.web)
        drivers = Remote(Drivers, HOST, master.bridge_port)
        watching = Remote(Guests, HOST, master.bridge_port, page_subscriptions())
        loads = [robots, pages, watching, drivers]
        for load in loads:
            stack.callback(load.close)
        until(lambda: pages.call("free") == players, 60, f"{players} robots are registered and on their topics")
        seats = pages.call("sign_up", players)
        watching.call("come", [(address(3, number), "") for number in range(spectators)])
        pages.call("battle")
        drivers.call("sit_down", seats)
        robots.call("fight", min(HITS, players))
        yield Loaded(master, robots, pages, drivers, watching, loads)


def measure(loaded: Loaded, players: int, seconds: float, rate: float = RATE) -> Row:
    masters, loads = loaded.master.pids, [load.pid for load in loaded.loads]
    loaded.drivers.call("drive", rate, WARM_UP)
    time.sleep(SETTLE)
    loaded.robots.call("collect")
    began = time.monotonic()
    before = {pid: cpu_seconds(pid) for pid in [*masters.values(), *loads]}
    sent = loaded.drivers.call("drive", rate, seconds)
    passed = time.monotonic() - began
    cores = {pid: (cpu_seconds(pid) - earlier) / passed for pid, earlier in before.items()}
    costs = {name: Costs(cores[pid], psutil.Process(pid).memory_info().rss) for name, pid in masters.items()}
    time.sleep(SETTLE)
    arrived = loaded.robots.call("collect")
    for people in (loaded.drivers, loaded.watching):
        if not people.call("is_complete"):
            raise RuntimeError("rosbridge has ended a connection")
    numbers = {
        robot: [(moment, NUMBER_OF[command]) for moment, command in commands if command in NUMBER_OF]
        for robot, commands in arrived.items()
    }
    figures = figures_of(0.0, list(sent.values()), [numbers.get(robot, []) for robot in sent], len(KEYS))
    return Row(players, costs, sum(cores[pid] for pid in loads), figures)


def show(row: Row, busy: float) -> None:
    lost = f"{row.figures.lost} of {row.figures.sent}"
    print(
        f"{row.players:8}"
        + "".join(f"{each.cpu:9.2f}{each.memory / 2**20:9.0f}" for each in row.costs.values())
        + f"{row.master:9.2f}{row.load:7.2f}{statistics.median(row.figures.latencies) * 1e3:9.2f}{row.p99 * 1e3:9.2f}"
        f"{lost:>16}{busy:16.1f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
