"""A host leaves a running fleet, and another takes its place."""

import json
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import requests
import yaml

from fleet import Machine
from tests.support.card import card_of, settings
from tests.support.containers import engine, remove
from tests.support.play import STOPPED, start
from tests.support.player import Player
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.rehearsal import FOLDER, INVENTORY, Playbook, Rehearsal, outside, power_off

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
    first.wait_for("TASK [host : Install the packages]", 120)
    # where dpkg notes what it is about, until it has done it all
    journal = "ls /var/lib/dpkg/updates | grep -q ."
    until(lambda: robot.host.run(journal).rc == 0, 120, "packages are being installed")
    first.stop(signal.SIGINT, 60)
    measured("broken off while packages are installed")
    # chrony and udev have their settings, and have not been told
    second = Playbook("deploy")
    second.wait_for("TASK [host : Apply these settings]", 240)
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


def test_the_masters_card_is_replaced(rehearsal: Rehearsal, tmp_path: Path, measured: Measured) -> None:
    """As docs/replace-the-master.md says. What was played is there, and who trusted the fleet's CA still does."""
    master = rehearsal.master
    with Player(rehearsal, "Ann") as ann, Player(rehearsal, "Bob") as bob:
        start(ann, bob)
        bob.post("signOutUser", data="Bob")
        ann.wait_for_game(STOPPED)
    played = results(rehearsal)
    assert played
    saved = f"--extra-vars=backup={tmp_path / 'evening.tar'}"
    measured("")
    rehearsal.playbook("backup", saved)
    measured("saved")
    assert (tmp_path / "evening.tar").stat().st_mode & 0o077 == 0
    authority = master.run("cat /etc/laserbot/ca/ca.crt")
    power_off(master)
    put_another_in_the_place_of(master)
    measured("another card is in")
    rehearsal.playbook("restore", saved)
    measured("restored")
    rehearsal.wait_until_complete()
    measured("all robots are back")
    assert results(rehearsal) == played
    assert master.run("cat /etc/laserbot/ca/ca.crt") == authority
    assert rehearsal.playbook("deploy").changed == 0
    rehearsal.playbook("check")


def results(rehearsal: Rehearsal) -> object:
    """The battles that were played, as everybody can read them."""
    return requests.get(f"{rehearsal.web}/results.json", timeout=5).json()["battles"]


def put_another_in_the_place_of(machine: Machine) -> None:
    """A Raspberry Pi with a fresh card, on which one may log in as root."""
    old = outside(machine)
    remove([old])
    engine().volumes.get(str(old.name)).remove()
    # the new one has another SSH key
    subprocess.run(["ssh-keygen", "-q", "-R", machine.address, "-f", str(FOLDER / "known_hosts")], check=True)
    robots = yaml.safe_load(INVENTORY.read_text())["robots"]["hosts"]
    subprocess.run([str(ROOT / "ci" / "fleet-hosts"), "up", str(len(robots))], check=True)
    until(lambda: machine.host.run("true").rc == 0, 60, "the old host's connection is given up")
    machine.run("install -D -m 600 /home/pi/.ssh/authorized_keys /root/.ssh/authorized_keys")
