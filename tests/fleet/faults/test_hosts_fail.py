"""Hosts that reboot or lose their power."""

from collections.abc import Callable

import pytest

from fleet import Machine
from tests.support.containers import execute
from tests.support.play import STOPPED, keep_turning, obeys, stands_still, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal, cut, outside, power_off, power_on

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]


def robot_of(rehearsal: Rehearsal, player: Player) -> Machine:
    return rehearsal.machines[f"raspberrypi{player.robot}"]


def test_the_master_loses_its_power_in_a_battle(rehearsal: Rehearsal, measured: Measured) -> None:
    with Player(rehearsal, "Ann") as ann, Player(rehearsal, "Bob") as bob, Eyes(rehearsal) as eyes:
        start(ann, bob)
        obeys(ann, eyes)
        # a plug takes no leave: no connection is closed
        with keep_turning(ann), cut(rehearsal.master):
            measured("")
            stands_still(ann, eyes)
            measured("the wheels stand still")
        power_off(rehearsal.master)
    power_on(rehearsal.master)
    measured("")
    until(lambda: rehearsal.available() >= 0, 120, "the server answers")
    measured("the server answers")
    rehearsal.wait_until_complete(120)
    measured("all robots have registered again")
    with Player(rehearsal, "Ann") as ann:
        assert ann.robot == 1, "the robots have their IDs"


def test_all_hosts_are_rebooted(rehearsal: Rehearsal, measured: Measured) -> None:
    rehearsal.playbook("reboot")
    measured("all healthy after reboot.yml, robots after the master")
    rehearsal.wait_until_complete(60)


@pytest.mark.parametrize("orderly", [False, True], ids=["pulled plug", "reboot"])
def test_a_robot_goes_down_in_a_battle(
    rehearsal: Rehearsal, players: tuple[Player, Player], measured: Measured, orderly: bool
) -> None:
    ann, bob = players
    start(ann, bob)
    measured("")
    robot = robot_of(rehearsal, bob)
    try:
        if orderly:
            execute(outside(robot), "systemctl", "--no-block", "reboot")
        else:
            power_off(robot)
        ann.wait_for_game(STOPPED)
        measured("its player is out")
        result = [(entry["place"], entry["name"], entry["left"]) for entry in ann.look()["result"]]
        assert result == [(1, "Ann", False), (2, "Bob", True)]
        bob.post("signOutUser", data="Bob")  # who keeps the seat for a while
    finally:
        if not orderly:
            power_on(robot)
            measured("")
    until(lambda: rehearsal.available() == len(rehearsal.robots) - 1, 120, "the robot is back")
    measured("the robot is back")
    with Player(rehearsal, "Cy") as cy, Player(rehearsal, "Di") as di:
        assert bob.robot in (cy.robot, di.robot), "with its ID"


def test_the_registry_is_down_when_a_robot_boots(rehearsal: Rehearsal, measured: Measured) -> None:
    robot = rehearsal.robots[0]
    rehearsal.master.run("systemctl stop docker-registry")
    try:
        power_off(robot)
        until(lambda: rehearsal.available() == len(rehearsal.robots) - 1, 10, "the robot is gone")
        power_on(robot)
        measured("")
        rehearsal.wait_until_complete(120)
        measured("the robot is back")
    finally:
        rehearsal.master.run("systemctl start docker-registry")
