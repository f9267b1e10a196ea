"""Networks that are cut or bad, names that are taken."""

import time
from collections.abc import Callable

import pytest

from tests.support.play import PLAYING, STOPPED, keep_turning, obeys, stands_still, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal, cut

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]
SEAT_KEPT = 10  # s from the moment at which the robot fell silent


def pause(seconds: float) -> None:
    """The length of the fault itself."""
    end = time.monotonic() + seconds
    until(lambda: time.monotonic() > end, seconds + 1)


def test_a_robots_network_is_cut_for_a_second(
    rehearsal: Rehearsal, players: tuple[Player, Player], measured: Measured
) -> None:
    ann, bob = players
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        obeys(ann, eyes)
        with cut(rehearsal.machines[f"raspberrypi{ann.robot}"]):
            pause(1)
        measured("")
        obeys(ann, eyes)
        measured("the robot obeys again")
        assert ann.user("Ann"), "its player is still there"
        assert ann.look()["game"] == PLAYING


@pytest.mark.parametrize("seconds", [5, 30])
def test_a_robots_network_is_cut_for_longer(
    rehearsal: Rehearsal, players: tuple[Player, Player], measured: Measured, seconds: int
) -> None:
    ann, bob = players
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        obeys(ann, eyes)
        with keep_turning(ann), cut(rehearsal.machines[f"raspberrypi{ann.robot}"]):
            measured("")
            stands_still(ann, eyes)
            measured("the wheels stand still")
            pause(seconds)
            assert bob.look()["game"] == STOPPED, "a robot that is silent for 3 s is out of the battle"
            assert bool(bob.user("Ann")) == (seconds < SEAT_KEPT), "its player keeps the seat for a while"
            ann.bridge.close()  # as her page does then: the robot does not hear of it
            ann.post("signOutUser", data="Ann")
        measured("")
        comes_back(rehearsal, bob, ann.robot, eyes, measured)


def comes_back(rehearsal: Rehearsal, bob: Player, robot: int, eyes: Eyes, measured: Measured) -> None:
    """A robot that was gone, not only to the server: it obeys its next player. Bob has the one robot that stayed."""
    until(lambda: rehearsal.available() == len(rehearsal.robots) - 1, 60, "the robot is back")
    measured("the robot is back")
    with Player(rehearsal, "Cy") as cy, Player(rehearsal, "Dee") as dee:
        (driver,) = (player for player in (cy, dee) if player.robot == robot)
        start(bob, driver)
        measured("its next player is in a battle")
        obeys(driver, eyes)
        measured("it obeys")


def test_a_third_of_a_robots_packets_are_lost(
    rehearsal: Rehearsal, players: tuple[Player, Player], measured: Measured
) -> None:
    """The robot obeys or, when too much is lost, is gone with its player by the rules; afterwards it is back."""
    ann, bob = players
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        with cut(rehearsal.machines[f"raspberrypi{ann.robot}"], share=30):
            pause(20)
        measured("")
        if bob.look()["game"] == PLAYING:
            obeys(ann, eyes)
            measured("the robot, in the battle all the time, obeys")
        else:
            ann.post("signOutUser", data="Ann")
            comes_back(rehearsal, bob, ann.robot, eyes, measured)


def test_avahi_restarts(rehearsal: Rehearsal, measured: Measured) -> None:
    for machine in rehearsal.machines.values():
        machine.run("systemctl restart avahi-daemon")
    measured("")
    for robot in rehearsal.robots:
        for name in ("laser_bot_master.local", "laser-bot-master.local"):
            ask = f"import socket;socket.gethostbyname('{name}')"
            until(lambda r=robot, a=ask: r.host.run(f'docker exec laserbot-robot python3 -c "{a}"').rc == 0, 30, name)
    measured("all names are known inside all robots' containers")
    rehearsal.wait_until_complete(30)


def test_a_second_master_appears(rehearsal: Rehearsal, measured: Measured) -> None:
    """Another host claims the master's name: it does not get it."""
    impostor = rehearsal.robots[-1]
    impostor.run("avahi-set-host-name laser_bot_master")
    try:
        measured("")
        for machine in (rehearsal.master, rehearsal.robots[0]):
            address = machine.run("getent ahostsv4 laser_bot_master.local").split()[0]
            assert address == rehearsal.master.address
        until(lambda: "laser_bot_master-2" in impostor.run("avahi-resolve --address " + impostor.address), 30)
        rehearsal.wait_until_complete(30)
    finally:
        impostor.run("systemctl restart avahi-daemon")
    until(lambda: impostor.name in rehearsal.master.run(f"avahi-resolve --address {impostor.address}"), 30)
    measured("the names are as before")


def test_the_master_comes_back_when_another_has_its_name(rehearsal: Rehearsal, measured: Measured) -> None:
    """It has no name until the other one leaves, and then both of its names again."""
    impostor, robot = rehearsal.robots[-1], rehearsal.robots[0]
    rehearsal.master.run("systemctl stop avahi-daemon.socket avahi-daemon")
    impostor.run("avahi-set-host-name laser_bot_master")
    try:
        rehearsal.master.run("systemctl start avahi-daemon")
        until(lambda: "laser_bot_master-2" in robot.run(f"avahi-resolve --address {rehearsal.master.address}"), 30)
        assert robot.host.run("avahi-resolve --name laser-bot-master.local").stdout == "", (
            "an alias of another's address"
        )
    finally:
        impostor.run("systemctl restart avahi-daemon")
    measured("")
    for name in ("laser_bot_master.local", "laser-bot-master.local"):
        until(lambda n=name: rehearsal.master.address in robot.host.run(f"getent ahostsv4 {n}").stdout, 60, name)
    measured("both names are the master's again")
    rehearsal.wait_until_complete(60)
