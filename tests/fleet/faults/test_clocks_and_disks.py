"""A robot whose clock is wrong, a robot whose disk is full."""

import shlex
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import pytest

from fleet import Machine
from tests.support.play import STOPPED, obeys, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal, copy_into

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]
SERVICE = "laserbot-robot"
LIBRARY = "/var/tmp/late_clock.so"
YEAR = 365 * 24 * 3600  # s
# what a full disk of a robot keeps from being written: the engine's notes of its containers, their logs, the journal
WRITTEN = ("/var/lib/docker/containers", "/var/log/journal")


@pytest.fixture
def late_clock(tmp_path: Path) -> Path:
    """A library that gives one program another time; the hosts of a rehearsal share the machine's clock."""
    library = tmp_path / "late_clock.so"
    source = Path(__file__).with_name("late_clock.c")
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", library, source], check=True)
    return library


def test_a_robots_clock_is_a_year_ahead(rehearsal: Rehearsal, late_clock: Path, measured: Measured) -> None:
    robot = rehearsal.robots[0]
    copy_into(robot, late_clock, LIBRARY)
    with another_clock(robot, YEAR):
        until(lambda: rehearsal.available() == len(rehearsal.robots) - 1, 10, "the server has noticed")
        measured("")
        rehearsal.wait_until_complete(60)
        measured("registered")
        told = datetime.strptime(robot.run("docker exec late date -u +%F").strip(), "%Y-%m-%d").replace(tzinfo=UTC)
        assert 360 < (told - datetime.now(UTC)).days < 370
        with Player(rehearsal, "Ann") as ann, Player(rehearsal, "Bob") as bob, Eyes(rehearsal) as eyes:
            assert ann.robot == 1
            start(ann, bob)
            obeys(ann, eyes)


@contextmanager
def another_clock(machine: Machine, ahead: int) -> Iterator[None]:
    """The robot's service, with all that it was given, in a container whose clock is `ahead` s ahead."""
    service = machine.container(SERVICE)
    given = service["HostConfig"]
    flags = [f"--env={variable}" for variable in service["Config"]["Env"]]
    flags += [f"--env=LATE_CLOCK={ahead}", f"--env=LD_PRELOAD={LIBRARY}"]
    flags += [f"--volume={bind}" for bind in [*given["Binds"], f"{LIBRARY}:{LIBRARY}:ro"]]
    flags += [f"--tmpfs={path}:{options}" for path, options in given["Tmpfs"].items()]
    flags += [f"--group-add={group}" for group in given["GroupAdd"]]
    flags += [f"--device-cgroup-rule={rule}" for rule in given["DeviceCgroupRules"]]
    flags += ["--network=host", "--read-only", "--cap-drop=ALL"]
    machine.run(f"docker stop {SERVICE}")
    machine.run(shlex.join(["docker", "run", "--detach", "--name=late", *flags, service["Config"]["Image"]]))
    try:
        yield
    finally:
        machine.run(f"docker rm --force late; rm {LIBRARY}; docker start {SERVICE}")


def test_a_robots_disk_is_full_in_a_battle(
    rehearsal: Rehearsal, players: tuple[Player, Player], measured: Measured
) -> None:
    ann, bob = players
    robot = rehearsal.machines[f"raspberrypi{ann.robot}"]
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        with full_disk(robot):
            obeys(ann, eyes)
            crash(robot)
            bob.wait_for_game(STOPPED)
            ann.post("signOutUser", data="Ann")  # who keeps the seat of a robot that is back soon
        measured("")
        until(lambda: rehearsal.available() == len(rehearsal.robots) - 1, 90, "the robot is back")
        measured("back after a crash, once there was room again")


@contextmanager
def full_disk(machine: Machine) -> Iterator[None]:
    """Small file systems without a free byte in the places where a running host writes."""
    for folder in WRITTEN:
        room = int(machine.run(f"du -sk {folder}").split()[0]) * 2
        small = f"mount -t tmpfs -o size={room}k tmpfs /mnt && cp -a {folder}/. /mnt/ && mount --move /mnt {folder}"
        machine.run(f"sh -c {shlex.quote(small)}")
        machine.host.run(f"dd if=/dev/zero of={folder}/filler bs=1k")
        assert machine.run(f"df --output=avail {folder}").split()[1] == "0"
    try:
        yield
    finally:
        for folder in WRITTEN:
            # a bind mount shows what is below the small file system: it gets what was noted meanwhile
            back = f"rm {folder}/filler && mount --bind {folder}/.. /mnt && cp -a {folder}/. /mnt/{Path(folder).name}/"
            machine.run(f"sh -c {shlex.quote(f'{back} && umount /mnt && umount --lazy {folder}')}")


def crash(machine: Machine) -> None:
    machine.run(f"kill -9 $(docker inspect --format '{{{{.State.Pid}}}}' {SERVICE})")
