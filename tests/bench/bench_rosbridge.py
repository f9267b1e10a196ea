"""What rosbridge costs: `python3 -m tests.bench.bench_rosbridge` prints CPU time, latency and memory as one table.

Any rosbridge server can be measured: `--url ws://127.0.0.1:9090 --pid N --label upstream`, with ROS_MASTER_URI as
the server has it. CPU time is that of the whole process. It depends on the pace: at a low one every message wakes the
server up, which on a virtual machine costs more than the message.
"""

import argparse
import contextlib
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

import psutil

from tests.bench.rosbridge_load import NUMBERS, Remote, RosSide, Sockets
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

SECONDS = 5.0
WARM_UP = 0.5  # s
SUBSCRIBERS = 50
SETTLE = 1.0  # s


class Server(NamedTuple):
    """The measured one."""

    url: str
    pid: int
    token: str


class Figures(NamedTuple):
    """Of one kind of work."""

    cpu: float  # s per message
    latencies: list[float]  # s
    rate: float  # messages/s
    lost: int
    sent: int


class Bench:
    """A server between its two ends."""

    def __init__(self, server: Server, sockets: Remote, ros: Remote) -> None:
        self._server = server
        self._sockets = sockets
        self._ros = ros

    def memory(self) -> dict[int, int]:
        """The resident memory (bytes) by the number of clients, who have subscribed and hear nothing."""
        process = psutil.Process(self._server.pid)
        sizes = {0: process.memory_info().rss}
        for clients in (50, 500):
            self._sockets.call("connect", clients)
            self._sockets.call("subscribe", "/bench_memory")
            time.sleep(SETTLE)
            sizes[clients] = process.memory_info().rss
        self._sockets.call("close")
        time.sleep(SETTLE)
        return sizes

    def publish(self, topics: list[str], rate: float, seconds: float) -> Figures:
        """From WebSockets to a ROS subscriber, each client on a topic of its own; `rate` is that of all together."""
        self._ros.call("subscribe", topics)
        self._sockets.call("connect", len(topics))
        self._sockets.call("advertise", topics)
        self._ros.call("wait_for_publishers")
        for duration in (WARM_UP, seconds):
            start = cpu_seconds(self._server.pid)
            sent = self._sockets.call("publish", topics, rate, duration)
            arrived = self._ros.call("collect")
            cpu = cpu_seconds(self._server.pid) - start
        self._ros.call("unsubscribe")
        self._sockets.call("close")
        return figures_of(cpu, [sent[client :: len(topics)] for client in range(len(topics))], arrived)

    def deliver(self, rate: float, seconds: float) -> Figures:
        """From a ROS publisher to WebSockets; a message counts once for each."""
        topic = f"/bench_delivery_{rate:.0f}"
        self._sockets.call("connect", SUBSCRIBERS)
        self._sockets.call("subscribe", topic)
        self._ros.call("advertise", topic)
        for duration in (WARM_UP, seconds):
            start = cpu_seconds(self._server.pid)
            self._sockets.start("collect")
            sent = self._ros.call("publish", rate, duration)
            arrived = self._sockets.result()
            cpu = cpu_seconds(self._server.pid) - start
        self._ros.call("unadvertise")
        self._sockets.call("close")
        return figures_of(cpu, [sent] * SUBSCRIBERS, arrived)


def main() -> None:
    """All rows."""
    arguments = parse_arguments()
    with contextlib.ExitStack() as stack:
        if arguments.url:
            server = Server(arguments.url, arguments.pid, arguments.token)
        else:
            server = stack.enter_context(our_rosbridge())
        address = urlsplit(server.url)
        sockets = Remote(Sockets, address.hostname, address.port, server.token)
        stack.callback(sockets.close)
        ros = Remote(RosSide)
        stack.callback(ros.close)
        print_table(Bench(server, sockets, ros), arguments)


def print_table(bench: Bench, arguments: argparse.Namespace) -> None:
    print(arguments.label)
    print(f"{'work':28}{'CPU us':>8}{'p50 ms':>10}{'p99 ms':>10}{'per s':>8}{'lost':>16}", flush=True)
    if "memory" in arguments.rows:
        sizes = ", ".join(f"{size / 2**20:.1f}" for size in bench.memory().values())
        print(f"memory with 0, 50, 500 clients: {sizes} MiB", flush=True)
    if "publish" in arguments.rows:
        for clients, rate in ((1, 4000), (50, 10)):
            topics = [arguments.topic.format(number) for number in range(clients)]
            show(f"publish, {clients} x {rate}/s", bench.publish(topics, clients * rate, arguments.seconds))
    if "delivery" in arguments.rows:
        for rate in (50, 500, 1000):
            show(f"delivery to {SUBSCRIBERS}, {rate}/s", bench.deliver(rate, arguments.seconds))


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="What a rosbridge server costs.")
    parser.add_argument("--url", help="of a server that runs (default: ours is started)")
    parser.add_argument("--pid", type=int, help="of that server")
    parser.add_argument("--token", default="", help="the operator's, if it wants one")
    parser.add_argument("--label", default="rosbridge", help="the table's title")
    parser.add_argument("--topic", default="/bench{}/command", help="to publish on, {} is the client's number")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each row")
    parser.add_argument("--rows", nargs="+", default=["memory", "publish", "delivery"], help="which kinds of work")
    arguments = parser.parse_args()
    if arguments.url and not arguments.pid:
        parser.error("--url needs --pid")
    return arguments


@contextmanager
def our_rosbridge() -> Iterator[Server]:
    """A ROS master and our rosbridge, open to everybody."""
    with tempfile.TemporaryDirectory(prefix="laserbot-bench-") as folder:
        master = RosMaster(Path(folder))
        os.environ.update(master.env)
        port = free_port()
        master.start()
        bridge = Program.python("server.rosbridge", "--open", "--port", str(port), env=master.env)
        try:
            bridge.wait_for("listening")
            yield Server(f"ws://127.0.0.1:{port}", bridge.process.pid, "")
            if "ERROR" in bridge.output:
                print(bridge.output)
        finally:
            bridge.stop()
            master.stop()


def figures_of(
    cpu: float, sent: list[list[float]], arrived: list[list[tuple[float, int]]], numbers: int = NUMBERS
) -> Figures:
    """`sent` has the times by number for each stream, `arrived` the times with the numbers modulo `numbers`."""
    latencies = []
    for there, here in zip(sent, arrived, strict=True):
        number = 0
        for moment, remainder in here:
            number += (remainder - number) % numbers
            latencies.append(moment - there[number])
    moments = [moment for here in arrived for moment, _ in here]
    count, total = len(moments), sum(map(len, sent))
    if count < 2:
        raise RuntimeError(f"{count} of {total} messages have arrived")
    return Figures(cpu / count, latencies, (count - 1) / (max(moments) - min(moments)), total - count, total)


def show(what: str, figures: Figures) -> None:
    p50, p99 = statistics.median(figures.latencies) * 1e3, statistics.quantiles(figures.latencies, n=100)[98] * 1e3
    lost = f"{figures.lost} of {figures.sent}"
    print(f"{what:28}{figures.cpu * 1e6:8.1f}{p50:10.2f}{p99:10.2f}{figures.rate:8.0f}{lost:>16}", flush=True)


def cpu_seconds(pid: int) -> float:
    """CPU time of another process and all its threads, in s (clock_getcpuclockid(3))."""
    return time.clock_gettime((~pid << 3) | 2)


if __name__ == "__main__":
    main()
