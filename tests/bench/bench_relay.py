"""What the cameras' relay costs: `python3 -m tests.bench.bench_relay` prints how late pictures are with 1, 10 and 50
viewers of one camera, what they cost the relay's processor and the robot's Wi-Fi, and what 4 cameras cost the drivers'
commands.

A camera sends 20 pictures of 31 kB a second, as 640x480 does. Latency is from the camera's program to the viewer's
socket; all are on this machine.
"""

import argparse
import contextlib
import os
import select
import socket
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit

from laser_bot_battle.master import Master
from laser_bot_battle.names import camera_parameter
from tests.bench.bench_rosbridge import Bench, Figures, Server, cpu_seconds, our_rosbridge
from tests.bench.bench_spectators import Referee
from tests.bench.rosbridge_load import Remote, RosSide, Sockets
from tests.support.fake_camera import FakeCamera
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.viewer import Shot, Viewer

VIEWERS = (1, 10, 50)
CAMERAS = DRIVERS = 4
PICTURES = 20  # a second, of a camera
SIZE = 31_000  # bytes of a picture
COMMANDS = 40  # a second, of a driver
SECONDS = 8.0
WARM_UP = 1.0  # s
TURNS = 3  # without and with cameras, one after the other: the machine is not the same at all times


class Cameras:
    """Those of robots 0, 1, ..."""

    def __init__(self, count: int) -> None:
        self._cameras = [FakeCamera(PICTURES, SIZE) for _ in range(count)]
        master = Master(os.environ["ROS_MASTER_URI"], "bench")
        for robot, camera in enumerate(self._cameras):
            camera.start()
            master.call("setParam", camera_parameter(robot), camera.url)

    def sent(self) -> int:
        """Bytes of all, so far."""
        return sum(camera.sent for camera in self._cameras)

    def connections(self) -> int:
        return sum(camera.connections for camera in self._cameras)

    def close(self) -> None:
        for camera in self._cameras:
            camera.stop()


class Crowd:
    """Guests who look."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._viewers: dict[socket.socket, Viewer] = {}

    def watch(self, robots: list[int]) -> None:
        """A viewer for each of these, instead of those before."""
        self.close()
        for robot in robots:
            viewer = Viewer(self._port)
            viewer.watch(robot)
            viewer.picture()
            self._viewers[viewer.socket] = viewer

    def look(self, seconds: float) -> list[float]:
        """How late (s) each picture was."""
        latencies, end = [], time.monotonic() + seconds
        while time.monotonic() < end:
            for ready in select.select(list(self._viewers), [], [], 0.1)[0]:
                now = time.monotonic()
                latencies += [now - said.mark.made for said in self._viewers[ready].drain() if isinstance(said, Shot)]
        return latencies

    def close(self) -> None:
        for viewer in self._viewers.values():
            viewer.close()
        self._viewers.clear()


class Relayed:
    """The relay between cameras and a crowd."""

    def __init__(self, pid: int, cameras: Remote, crowd: Remote) -> None:
        self._pid, self._cameras, self.crowd = pid, cameras, crowd

    def row(self, viewers: int, seconds: float) -> None:
        """So many look through one camera."""
        self.crowd.call("watch", [0] * viewers)
        self.crowd.call("look", WARM_UP)
        begin, cpu, sent = time.monotonic(), cpu_seconds(self._pid), self._cameras.call("sent")
        latencies = self.crowd.call("look", seconds)
        passed, cpu = time.monotonic() - begin, cpu_seconds(self._pid) - cpu
        robot = (self._cameras.call("sent") - sent) / passed
        cuts = statistics.quantiles(latencies, n=100)
        print(
            f"{viewers:8}{cuts[49] * 1e3:9.2f}{cuts[94] * 1e3:9.2f}{cuts[98] * 1e3:9.2f}"
            f"{len(latencies) / viewers / passed:14.1f}{cpu / len(latencies) * 1e6:16.0f}{cpu / passed * 100:8.1f}"
            f"{robot / 1000:16.0f}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description="What the cameras' relay costs.")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each row")
    arguments = parser.parse_args()
    with contextlib.ExitStack() as stack:
        bridge = stack.enter_context(our_rosbridge())
        referee = Remote(Referee)
        stack.callback(referee.close)
        port, pid = stack.enter_context(our_relay())
        cameras, crowd = Remote(Cameras, CAMERAS), Remote(Crowd, port)
        stack.callback(cameras.close)
        stack.callback(crowd.close)
        relayed = Relayed(pid, cameras, crowd)
        print(
            f"{'viewers':>8}{'p50 ms':>9}{'p95 ms':>9}{'p99 ms':>9}{'pictures/s':>14}{'CPU us/picture':>16}{'CPU %':>8}"
            f"{'robot sends kB/s':>18}"
        )
        for viewers in VIEWERS:
            relayed.row(viewers, arguments.seconds)
        print(f"the robot's camera was connected to {cameras.call('connections')} times")
        commands(stack, bridge, crowd, arguments.seconds)


def commands(stack: contextlib.ExitStack, bridge: Server, crowd: Remote, seconds: float) -> None:
    """Of drivers through rosbridge, while nobody looks, and while each looks through the own camera."""
    address = urlsplit(bridge.url)
    drivers, ros = Remote(Sockets, address.hostname, address.port, ""), Remote(RosSide)
    stack.callback(drivers.close)
    stack.callback(ros.close)
    bench = Bench(bridge, drivers, ros)
    topics = [f"/bench{number}/command" for number in range(DRIVERS)]
    found: dict[int, list[Figures]] = {0: [], CAMERAS: []}
    for _ in range(TURNS):
        for streams, figures in found.items():
            crowd.call("watch", list(range(streams)))
            if streams:
                crowd.start("look", seconds + 2 * WARM_UP)
            figures.append(bench.publish(topics, DRIVERS * COMMANDS, seconds))
            if streams:
                crowd.result()
    print(f"{DRIVERS} drivers at {COMMANDS} Hz through rosbridge")
    print(f"{'camera streams':>16}{'p50 ms':>9}{'p99 ms':>9}")
    medians = []
    for streams, figures in found.items():
        cuts = statistics.quantiles([latency for each in figures for latency in each.latencies], n=100)
        medians.append(cuts[49])
        print(f"{streams:16}{cuts[49] * 1e3:9.2f}{cuts[98] * 1e3:9.2f}")
    print(f"the cameras cost a command {(medians[1] - medians[0]) * 1e3:.2f} ms (p50; budget 2 ms)", flush=True)


@contextmanager
def our_relay() -> Iterator[tuple[int, int]]:
    """On the ROS master of this environment; its port and process."""
    port = free_port()
    limits = {"LASERBOT_RELAY_VIEWERS": "400", "LASERBOT_RELAY_RATE": "10000"}
    relay = Program.python("server.camera", env={"LASERBOT_RELAY_PORT": str(port), **limits})
    try:
        relay.wait_for("listening")
        yield port, relay.process.pid
        if "ERROR" in relay.output:
            print(relay.output)
    finally:
        relay.stop()


if __name__ == "__main__":
    main()
