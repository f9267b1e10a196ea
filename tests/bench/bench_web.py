"""What the game's web server costs: `python3 -m tests.bench.bench_web` prints CPU time, latency, rate and memory.

50 pages of players in a battle and 50 robots, first at their pace, then each as fast as it is answered. `--tree FOLDER`
measures another version of this repository, where `ci/messages` has been run. CPU time is that of the whole process,
per request of either kind; the least of some runs, since other programs' work only adds to it.
"""

import argparse
import contextlib
import os
import statistics
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import psutil

from tests.bench.bench_rosbridge import cpu_seconds
from tests.bench.rosbridge_load import Remote
from tests.bench.web_load import Fleet, Times, Visitors
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program
from tests.support.ros import HOST, RosMaster

PAGES = ROBOTS = 50
PAGE_PERIOD = 0.5  # s, as the manual's page asks
ROBOT_PERIOD = 0.4  # s


def main() -> None:
    parser = argparse.ArgumentParser(description="What the game's web server costs.")
    parser.add_argument("--tree", type=Path, default=ROOT, help="checkout whose server is measured (default: this one)")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each run")
    parser.add_argument("--runs", type=int, default=3, help="of each kind")
    arguments = parser.parse_args()
    with contextlib.ExitStack() as stack:
        master = stack.enter_context(ros_master())
        url, pid = stack.enter_context(web_server(arguments.tree.resolve(), master))
        process = psutil.Process(pid)
        memory = [process.memory_info().rss]
        fleet = Remote(Fleet)
        stack.callback(fleet.close)
        visitors = Remote(Visitors, url)
        stack.callback(visitors.close)
        visitors.call("add_robots", fleet.call("register", ROBOTS))
        visitors.call("add_pages", PAGES)
        print(f"{'load':20}{'request':>18}{'CPU us':>8}{'p50 ms':>9}{'p99 ms':>9}{'per s':>8}")
        for what, periods in (("as they ask", (PAGE_PERIOD, ROBOT_PERIOD)), ("as fast as they can", (0.0, 0.0))):
            costs: list[float] = []
            runs: list[Mapping[str, Times]] = []
            for _ in range(arguments.runs):
                before = cpu_seconds(pid)
                runs.append(visitors.call("load", arguments.seconds, *periods))
                costs.append((cpu_seconds(pid) - before) / sum(len(each.latencies) for each in runs[-1].values()))
            show(what, costs, runs)
            memory.append(process.memory_info().rss)
        sizes = ", ".join(f"{size / 2**20:.1f}" for size in memory)
        print(f"memory at first, after the one, after the other: {sizes} MiB")


def show(what: str, costs: list[float], runs: list[Mapping[str, Times]]) -> None:
    for route in runs[0]:
        latencies = [latency for run in runs for latency in run[route].latencies]
        p50, p99 = statistics.median(latencies) * 1e3, statistics.quantiles(latencies, n=100)[98] * 1e3
        rate = max(len(run[route].latencies) / run[route].duration for run in runs)
        print(f"{what:20}{route:>18}{min(costs) * 1e6:8.0f}{p50:9.2f}{p99:9.2f}{rate:8.0f}", flush=True)


@contextlib.contextmanager
def ros_master() -> Iterator[RosMaster]:
    with tempfile.TemporaryDirectory(prefix="laserbot-bench-") as folder:
        master = RosMaster(Path(folder))
        os.environ.update(master.env)
        master.start()
        try:
            yield master
        finally:
            master.stop()


@contextlib.contextmanager
def web_server(tree: Path, master: RosMaster) -> Iterator[tuple[str, int]]:
    """The URL and the process of the server of that tree, in the midst of an evening."""
    port = free_port()
    settings = {
        "LASERBOT_BIND": HOST,
        "LASERBOT_WEB_PORT": str(port),
        "LASERBOT_DATA": str(Path(master.env["ROS_HOME"]) / "data"),
        "LASERBOT_COUNTDOWN": "1",
        "LASERBOT_BATTLE_LIMIT": "3600",
    }
    path = {"PYTHONPATH": f"{tree}:{tree / 'build' / 'python'}"}
    command = ["env", f"--chdir={tree}", sys.executable, "-m", "server.main"]
    server = Program(command, {**master.env, **path, **settings})
    try:
        server.wait_for("serving", 60)
        yield f"http://{HOST}:{port}", server.process.pid
    finally:
        server.stop()


if __name__ == "__main__":
    main()
