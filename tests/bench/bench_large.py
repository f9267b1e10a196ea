"""What large messages cost the drivers: `python3 -m tests.bench.bench_large` prints the latency of commands through
rosbridge, of 4 drivers at 40 Hz each, while pages get maps and a client sends one again and again.
"""

import argparse
import contextlib
import math
import statistics
import time
from urllib.parse import urlsplit

import psutil
import rospy
from nav_msgs.msg import OccupancyGrid

from tests.bench.bench_rosbridge import Bench, cpu_seconds, our_rosbridge
from tests.bench.bench_spectators import DRIVERS, RATE, Guests
from tests.bench.rosbridge_load import Remote, RosSide, Sockets
from tests.support.bare import BareClient

SECONDS = 20.0
EVERY = 3.0  # s
ROWS = ((0, "none"), (2000, "none"), (4000, "none"), (4000, "png"), (4000, "cbor"))  # cells of a side; compression
SENT = 1200  # cells of a side: 8 MiB of JSON is the longest request


class Maps:
    """Publishes a map again and again."""

    def __init__(self) -> None:
        rospy.init_node("bench_maps", anonymous=True, disable_signals=True)
        self._timer: rospy.Timer | None = None
        self._publisher = rospy.Publisher("/map", OccupancyGrid, queue_size=1)

    def publish(self, side: int) -> None:
        if self._timer is not None:
            self._timer.shutdown()
            self._timer = None
        if side:
            cells = [(cell * 7) % 102 - 1 for cell in range(side)] * side
            message = OccupancyGrid(data=cells)
            self._timer = rospy.Timer(rospy.Duration(EVERY), lambda _: self._publisher.publish(message))

    def close(self) -> None:
        rospy.signal_shutdown("done")


class Sender:
    """A client that sends the longest request there is, again and again, as long as it is told to."""

    def __init__(self, host: str, port: int) -> None:
        self._client = BareClient(port, host=host)
        self._client.say("advertise", topic="/drawn", type=OccupancyGrid._type)

    def send(self, seconds: float) -> int:
        """How often."""
        cells = [(cell * 7) % 102 - 1 for cell in range(SENT)] * SENT
        text = {"topic": "/drawn", "msg": {"data": cells}}
        end, times = time.monotonic() + seconds, 0
        while time.monotonic() < end:
            self._client.say("publish", **text)
            self._client.say("call_service", service="/rosapi/get_time")
            self._client.hear()
            times += 1
        return times

    def close(self) -> None:
        self._client.close()


def main() -> None:
    parser = argparse.ArgumentParser(description="What large messages cost the drivers.")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each row")
    arguments = parser.parse_args()
    with contextlib.ExitStack() as stack:
        server = stack.enter_context(our_rosbridge())
        address = urlsplit(server.url)
        drivers = Remote(Sockets, address.hostname, address.port, "")
        ros, maps = Remote(RosSide), Remote(Maps)
        for remote in (drivers, ros, maps):
            stack.callback(remote.close)
        bench = Bench(server, drivers, ros)
        topics = [f"/bench{number}/command" for number in range(DRIVERS)]
        print(f"{DRIVERS} drivers at {RATE} Hz; a map each {EVERY:g} s to one page")
        print(f"{'work':24}{'p50 ms':>10}{'p99 ms':>10}{'worst':>10}{'lost':>16}{'CPU s a map':>13}", flush=True)
        for side, compression in ROWS:
            subscription: dict[str, object] = {"op": "subscribe", "topic": "/map", "compression": compression}
            page = Remote(Guests, address.hostname, address.port, [subscription])
            page.call("watch", 1)
            maps.call("publish", side)
            show(bench, topics, arguments.seconds, f"{side} x {side}, {compression}" if side else "none", server.pid)
            maps.call("publish", 0)
            page.close()
        sender = Remote(Sender, address.hostname, address.port)
        stack.callback(sender.close)
        sender.start("send", arguments.seconds)
        show(bench, topics, arguments.seconds, f"{SENT} x {SENT} sent", server.pid)
        print(f"    sent {sender.result()} times")


def show(bench: Bench, topics: list[str], seconds: float, what: str, pid: int) -> None:
    before = cpu_of(pid)
    figures = bench.publish(topics, DRIVERS * RATE, seconds)
    spent = (cpu_of(pid) - before) / math.floor(seconds / EVERY)
    p50, p99 = statistics.median(figures.latencies) * 1e3, statistics.quantiles(figures.latencies, n=100)[98] * 1e3
    lost = f"{figures.lost} of {figures.sent}"
    print(f"{what:24}{p50:10.2f}{p99:10.2f}{max(figures.latencies) * 1e3:10.1f}{lost:>16}{spent:13.2f}", flush=True)


def cpu_of(pid: int) -> float:
    """s, of the program and the process that it has for large messages."""
    return cpu_seconds(pid) + sum(cpu_seconds(child.pid) for child in psutil.Process(pid).children())


if __name__ == "__main__":
    main()
