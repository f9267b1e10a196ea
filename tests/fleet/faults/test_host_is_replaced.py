"""A host leaves a running fleet, and another takes its place."""

import json
import signal
import subprocess
from collections.abc import Callable

import pytest

from fleet import Machine
from tests.support.card import card_of, settings
from tests.support.player import Player
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.rehearsal import FOLDER, Playbook, Rehearsal, docker, outside, power_off

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]


def test_a_robot_is_replaced_though_the_deploy_is_broken_off(rehearsal: Rehearsal, measured: Measured) -> None:
    robot = rehearsal.robots[1]
    power_off(robot)
    put_another_in_the_place_of(robot)

    refused = rehearsal.playbook("deploy", "--limit=raspberrypi2", "--extra-vars=ansible_user=root", check=False)
    assert "This run logs in as root. That would not work any more" in refused.output
    dry = rehearsal.playbook("deploy", "--check", "--diff")
    assert all(row["failed"] == 0 for row in dry.recap.values())
    assert settings(robot.run) == settings(card_of(robot)), "a dry run changes nothing"

    measured("")
    first = Playbook("deploy")
    first.wait_for("TASK [host : Install the packages of all hosts]", 120)
    # where dpkg notes what it is about, until it has done it all
    journal = "ls /var/lib/dpkg/updates | grep -q ."
    until(lambda: robot.host.run(journal).rc == 0, 120, "packages are being installed")
    first.stop(signal.SIGINT, 60)
    measured("broken off while packages are installed")
    # chrony and udev have their settings, and have not been told
    second = Playbook("deploy")
    second.wait_for("TASK [host : Log in over SSH with keys only]", 240)
    second.stop(signal.SIGINT, 60)
    measured("broken off between settings and restarts")
    run = rehearsal.playbook("deploy")
    measured("run to its end")
    assert run.recap[robot.name]["changed"] > 10
    images = {json.loads(one.run("cat /etc/laserbot/release.json"))["current"] for one in rehearsal.robots}
    assert images == {one.container("laserbot-robot")["Config"]["Image"] for one in rehearsal.robots}
    rehearsal.wait_until_complete()
    measured("all robots play")
    rehearsal.playbook("check")
    assert rehearsal.playbook("deploy").changed == 0
    with Player(rehearsal, "Ann"), Player(rehearsal, "Bob") as bob:
        assert f"raspberrypi{bob.robot}" == robot.name, "it has the ID of the one before"


def put_another_in_the_place_of(robot: Machine) -> None:
    """A Raspberry Pi with a fresh card, on which one may log in as root."""
    docker("rm", "--force", "--volumes", outside(robot))
    docker("volume", "rm", outside(robot))
    # the new one has another SSH key
    subprocess.run(["ssh-keygen", "-q", "-R", robot.address, "-f", str(FOLDER / "known_hosts")], check=True)
    subprocess.run([str(ROOT / "ci" / "fleet-hosts"), "up"], check=True)
    until(lambda: robot.host.run("true").rc == 0, 60, "the old host's connection is given up")
    robot.run("install -D -m 600 /home/pi/.ssh/authorized_keys /root/.ssh/authorized_keys")
