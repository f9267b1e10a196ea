"""What spectators cost the drivers: `python3 -m tests.bench.bench_spectators` prints the latency of commands through
rosbridge, of 4 drivers at 40 Hz each, while 0, 50 and 200 guests watch a battle as the page /watch does: its state,
where the robots are, which of them shoot and which are covered, and how the camera above sees the floor.
"""

import argparse
import contextlib
import itertools
import json
import re
import selectors
import statistics
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import urlsplit

import rospy

from laser_bot_battle.msg import (
    GameStatus,
    OverheadCovered,
    OverheadView,
    Positions,
    RobotPosition,
    Shot,
    UserStatus,
)
from laser_bot_battle.names import GAME_STATUS, OVERHEAD_COVERED, OVERHEAD_VIEW, POSITIONS, SHOTS
from tests.bench.bench_rosbridge import Bench, Figures, cpu_seconds, our_rosbridge
from tests.bench.rosbridge_load import SIGN_OF_LIFE, Remote, RosSide, Sockets
from tests.support.bare import PONG, BareClient, frame
from tests.support.programs import ROOT

GUESTS = (0, 50, 200)
DRIVERS = 4
RATE = 40  # commands/s of each
CHANGES = 10  # states/s of a fierce battle
SIGHTS = 15  # positions/s
SHOOTING = 2  # positions from one shot to the next: four robots that shoot as fast as they can
COVERING = 8  # positions until other robots are covered
SECONDS = 10.0
PAGES = Path("server/static/js")
TOPIC = re.compile(r'\{\s*topic: "([^"]+)", type: "([^"]+)",(.*?)take:', re.DOTALL)


class Referee:
    """Publishes a battle that changes all the time, and robots that never stand still."""

    def __init__(self) -> None:
        rospy.init_node("bench_referee", anonymous=True, disable_signals=True)
        self._publisher = rospy.Publisher(GAME_STATUS, GameStatus, latch=True, queue_size=10)
        self._positions = rospy.Publisher(POSITIONS, Positions, queue_size=1)
        self._shots = rospy.Publisher(SHOTS, Shot, queue_size=10)
        self._covered = rospy.Publisher(OVERHEAD_COVERED, OverheadCovered, latch=True, queue_size=10)
        self._view = rospy.Publisher(OVERHEAD_VIEW, OverheadView, latch=True, queue_size=1)
        self._view.publish(OverheadView(width=1280, height=720))
        self._over = threading.Event()
        self._threads = [threading.Thread(target=target) for target in (self._play, self._see)]
        for thread in self._threads:
            thread.start()

    def _see(self) -> None:
        walls = [0.0, 0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 2.25, 4.0, 2.25, 0.0, 2.25, 0.0, 2.25, 0.0, 0.0]
        for sight in itertools.count():
            if self._over.wait(1 / SIGHTS):
                return
            turn = sight / 10
            if sight % SHOOTING == 0:
                self._shots.publish(Shot(robot=sight // SHOOTING % DRIVERS))
            if sight % COVERING == 0:
                self._covered.publish(OverheadCovered([sight // COVERING % DRIVERS]))
            robots = [RobotPosition(number, number + turn % 1, 1 + turn % 0.7, turn % 3) for number in range(DRIVERS)]
            self._positions.publish(Positions(width=4, height=2.25, walls=walls, robots=robots))

    def _play(self) -> None:
        life = 100
        while not self._over.wait(1 / CHANGES):
            life = life - 1 or 100
            users = [
                UserStatus(name=f"driver{number}", robot=number, life=life, ready=True) for number in range(DRIVERS)
            ]
            self._publisher.publish(GameStatus(game=GameStatus.PLAYING, time_left=life, battle=1, users=users))

    def close(self) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join()
        rospy.signal_shutdown("done")


class Guests:
    """Pages that watch; they read what comes and answer nothing."""

    def __init__(self, host: str, port: int, subscriptions: Sequence[dict[str, object]]) -> None:
        self._host, self._port, self._subscriptions = host, port, subscriptions
        self._clients: list[BareClient] = []
        self._selector = selectors.DefaultSelector()
        self._bytes = 0
        self._over = threading.Event()
        self._thread: threading.Thread | None = None

    def watch(self, count: int) -> None:
        """Until there are `count` of them."""
        self.come([("", "")] * count)

    def come(self, visitors: Sequence[tuple[str, str]]) -> None:
        """These, by their address and cookie ("": any, none), instead of those who were here."""
        self.close()
        self._over.clear()
        for address, cookie in visitors:
            headers = {"Cookie": cookie} if cookie else None
            client = BareClient(self._port, headers, host=self._host, source=address)
            for subscription in self._subscriptions:
                client.say(**subscription)  # type: ignore[arg-type]
            self._clients.append(client)
            self._selector.register(client.socket, selectors.EVENT_READ)
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def is_complete(self) -> bool:
        """Whether rosbridge has sent none of them away."""
        return self._thread is not None and self._thread.is_alive()

    def heard(self) -> int:
        """Bytes, since they were asked last."""
        count, self._bytes = self._bytes, 0
        return count

    def close(self) -> None:
        self._over.set()
        if self._thread:
            self._thread.join()
        for client in self._clients:
            self._selector.unregister(client.socket)
            client.close()
        self._clients.clear()

    def _read(self) -> None:
        alive = time.monotonic()
        pong = frame(b"", PONG)
        while not self._over.is_set():
            for key, _ in self._selector.select(0.1):
                data = key.fileobj.recv(1 << 18)  # type: ignore[union-attr]
                if not data:
                    raise ConnectionError("rosbridge has ended a guest's connection")
                self._bytes += len(data)
            if time.monotonic() > alive + SIGN_OF_LIFE:
                alive = time.monotonic()
                for client in self._clients:
                    client.send(pong)


def main() -> None:
    parser = argparse.ArgumentParser(description="What spectators cost the drivers.")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each row")
    arguments = parser.parse_args()
    with contextlib.ExitStack() as stack:
        server = stack.enter_context(our_rosbridge())
        address = urlsplit(server.url)
        drivers = Remote(Sockets, address.hostname, address.port, "")
        stack.callback(drivers.close)
        ros = Remote(RosSide)
        stack.callback(ros.close)
        referee = Remote(Referee)
        stack.callback(referee.close)
        guests = Remote(Guests, address.hostname, address.port, page_subscriptions())
        stack.callback(guests.close)
        bench = Bench(server, drivers, ros)
        topics = [f"/bench{number}/command" for number in range(DRIVERS)]
        print(f"{DRIVERS} drivers at {RATE} Hz, {CHANGES} states/s, {SIGHTS} positions/s")
        print(f"{'guests':>8}{'p50 ms':>10}{'p99 ms':>10}{'lost':>16}{'CPU %':>8}{'kB/s to all':>14}", flush=True)
        for count in GUESTS:
            guests.call("watch", count)
            guests.call("heard")
            begin, cpu = time.monotonic(), cpu_seconds(server.pid)
            figures = bench.publish(topics, DRIVERS * RATE, arguments.seconds)
            passed = time.monotonic() - begin
            show(count, figures, (cpu_seconds(server.pid) - cpu) / passed, guests.call("heard") / passed)


def page_subscriptions() -> list[dict[str, object]]:
    """What the page sends, from its source: for the state, and for what it draws."""
    feed = _source("battle/status_feed.js")
    (text,) = re.findall(r"^const SUBSCRIPTION = (\{.*?^\});", feed, re.DOTALL | re.MULTILINE)
    without_comments = re.sub(r"//.*", "", text)
    quoted = re.sub(r"(\w+):", r'"\1":', without_comments)
    status = dict(json.loads(re.sub(r",\s*\}", "}", quoted)))
    assert "topics: [...arena.topics, ...realFloor.topics]" in _source("watch/watch.js")
    return [status, *_topics("arena/arena_view.js"), *_topics("overhead/floor_picture.js")]


def _topics(module: str) -> Iterator[dict[str, object]]:
    """The subscriptions for the `topics` of that module."""
    source = _source(module)
    constants = dict(re.findall(r"^const ([A-Z]+) = (\d+);", source, re.MULTILINE))
    for topic, kind, options in TOPIC.findall(source):
        values = {name: int(constants.get(value, value)) for name, value in re.findall(r"(\w+): (\w+)", options)}
        yield {"op": "subscribe", "id": f"subscribe:{topic}", "topic": topic, "type": kind, **values}


def _source(module: str) -> str:
    return (ROOT / PAGES / module).read_text()


def show(guests: int, figures: Figures, load: float, rate: float) -> None:
    p50, p99 = statistics.median(figures.latencies) * 1e3, statistics.quantiles(figures.latencies, n=100)[98] * 1e3
    lost = f"{figures.lost} of {figures.sent}"
    print(f"{guests:8}{p50:10.2f}{p99:10.2f}{lost:>16}{load * 100:8.1f}{rate / 1000:14.0f}", flush=True)


if __name__ == "__main__":
    main()
