"""Viewers that do not read, or pretend to: they cost themselves their pictures, and nobody else time or memory."""

import contextlib
import statistics
import threading
import time
from collections.abc import Callable

import psutil
import pytest

from tests.integration.camera.conftest import Relay
from tests.integration.rosbridge.ends import RosSide
from tests.support.bare import text_of
from tests.support.fake_camera import FakeCamera
from tests.support.ros import RosMaster
from tests.support.viewer import Viewer, look

Start = Callable[..., tuple[int, FakeCamera]]
Connect = Callable[..., Viewer]


def resident(relay: Relay) -> int:
    """Bytes."""
    return int(psutil.Process(relay.program.process.pid).memory_info().rss)


def lateness(someone: Viewer, seconds: float) -> list[float]:
    """How old (s) pictures are when they come."""
    ages, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        ages.append(-someone.picture().mark.made + time.monotonic())
    return ages


@pytest.mark.slow
def test_who_never_reads_delays_nobody_costs_little_and_is_given_up(
    camera: Start, viewer: Connect, relay: Relay
) -> None:
    robot, eye = camera(rate=20, size=200_000)
    quick = viewer()
    quick.watch(robot)
    quick.picture()
    before = resident(relay)
    stuck = [viewer(receive_buffer=4096) for _ in range(20)]
    for each in stuck:
        each.watch(robot)
    operator = viewer().operate()
    ages = []
    for _ in range(60):
        ages.append(-quick.picture().mark.made + time.monotonic())
        for each in stuck:
            with contextlib.suppress(OSError):  # on a slow machine, it may have been given up already
                each.say("seen")  # as if it had drawn what it has not even read
    assert statistics.median(ages) < 0.1
    # none keeps any of the 60 pictures of 200 kB that came meanwhile
    assert resident(relay) - before < 10 * 2**20
    assert operator.metrics()["mbit"] < 2 * 32  # what is not sent does not count: there is one who reads
    relay.program.wait_for("given up, it has not read for 5 s", 15)
    assert quick.picture().robot == robot
    assert eye.connections == 1


def test_whoever_reads_slowly_sees_the_newest(camera: Start, viewer: Connect) -> None:
    robot, _ = camera(rate=20)
    slow, quick = viewer(), viewer()
    slow.draws = False
    slow.watch(robot)
    quick.watch(robot)
    slow.picture()
    slow.picture()
    for _ in range(3):
        for _ in range(8):
            newest = quick.picture().number
        slow.say("seen")
        assert slow.picture().number >= newest


@pytest.mark.slow
def test_a_flood_of_messages_does_not_keep_others_waiting(camera: Start, viewer: Connect) -> None:
    robot, _ = camera(rate=20)
    quick, rude = viewer(), viewer()
    quick.watch(robot)
    rude.watch(robot)
    quick.picture()
    over = threading.Event()
    words = text_of("watch", robot=robot) * 50 + text_of("seen") * 50

    def shout() -> None:
        while not over.is_set():
            rude.send(words)
            rude.drain()

    thread = threading.Thread(target=shout)
    thread.start()
    try:
        ages = lateness(quick, 1.5)
    finally:
        over.set()
        thread.join()
    assert statistics.median(ages) < 0.15


def test_beyond_the_rate_spectators_get_fewer_and_operators_all(
    camera: Start, ros_master: RosMaster, referee: RosSide
) -> None:
    robot, _ = camera(rate=20, size=25_000)  # 4 Mbit/s for each viewer
    with (
        Relay(ros_master, LASERBOT_RELAY_RATE="5") as relay,
        Viewer(relay.port) as operator,
        Viewer(relay.port) as one,
        Viewer(relay.port) as two,
    ):
        operator.operate().metrics()
        for each in (operator, one, two):
            each.watch(robot)
        first = operator.picture().mark.number
        look((operator, one, two), lambda: operator.shots > 40)
        last = operator.picture().mark.number
        assert operator.shots > 0.9 * (last - first)
        # 1 Mbit/s is left for two, who would have 8
        assert 4 < one.shots + two.shots < 30
        assert min(one.shots, two.shots) >= 2
        assert operator.metrics()["mbit"] < 7
