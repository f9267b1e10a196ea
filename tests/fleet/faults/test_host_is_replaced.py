"""A host leaves the fleet, and another takes its place."""

import json
import re
import signal
import subprocess
from collections.abc import Callable

from tests.support.fleet import Machine
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.rehearsal import FOLDER, Playbook, Rehearsal, ask_from, docker, outside

Measured = Callable[[str], None]

# What is different on each host, or is left by Debian's packages when they are purged: backups.
OWN = re.compile(
    r"/etc/(machine-id|ssh/ssh_host_.*|resolv\.conf|hosts|hostname|ld\.so\.cache|.*-|\.pwd\.lock|\.updated|mailcap|networks|.*/\.wh\..*)"
)


def test_a_fleet_is_torn_down_and_comes_back_with_another_host_though_the_deploy_is_broken_off(
    rehearsal: Rehearsal, measured: Measured
) -> None:
    rehearsal.playbook("teardown", "--extra-vars=data=remove")
    measured("torn down, data as well")
    for machine in rehearsal.machines.values():
        more = packages(machine.run) - packages(card_of(machine))
        of_others = set(machine.run("apt-mark showauto").split())
        assert more <= of_others, "what packages of the host recommend may stay"
        theirs = set(machine.run(f"dpkg --listfiles {' '.join(more)}").split()) if more else set()
        kept = {path: what for path, what in settings(machine.run).items() if path not in theirs}
        assert kept == settings(card_of(machine)), machine.name
        assert machine.host.run("ls -d /etc/laserbot /var/lib/laserbot /var/lib/docker-registry").stdout == ""
        reach = f"import socket; socket.create_connection(('{machine.address}', 22), 5).close(); print('reached')"
        assert ask_from("laserbot-fleet", reach).strip() == "reached", "there is no firewall any more"

    # another Raspberry Pi with a fresh card
    robot = rehearsal.robots[1]
    docker("rm", "--force", "--volumes", f"laserbot-fleet-{robot.name}")
    docker("volume", "rm", f"laserbot-fleet-{robot.name}")
    forget(robot)
    subprocess.run([str(ROOT / "ci" / "fleet-hosts"), "up"], check=True)
    until(lambda: robot.host.run("true").rc == 0, 60, "the old host's connection is given up")

    dry = rehearsal.playbook("deploy", "--check", "--diff")
    assert all(row["failed"] == 0 for row in dry.recap.values())
    assert settings(robot.run) == settings(card_of(robot)), "a dry run changes nothing"

    measured("")
    first = Playbook("deploy")
    first.wait_for("TASK [host : Install the packages of all hosts]", 120)
    unpacked = "grep -q 'Status: install ok unpacked' /var/lib/dpkg/status"
    until(lambda: robot.host.run(unpacked).rc == 0, 120, "packages are being installed")
    first.stop(signal.SIGINT, 60)
    measured("broken off")
    run = rehearsal.playbook("deploy")
    measured("run again to its end")
    assert run.recap[robot.name]["changed"] > 10
    images = {json.loads(one.run("cat /etc/laserbot/release.json"))["current"] for one in rehearsal.robots}
    assert images == {one.container("laserbot-robot")["Config"]["Image"] for one in rehearsal.robots}
    rehearsal.wait_until_complete()
    measured("all robots play")


def card_of(machine: Machine) -> Callable[[str], str]:
    """Runs commands on a system as it comes from the imager; the machine's own was one."""
    image = docker("inspect", "--format={{.Config.Image}}", outside(machine)).strip()
    return lambda command: docker("run", "--rm", "--entrypoint=sh", image, "-c", command)


def settings(run: Callable[[str], str]) -> dict[str, str]:
    """Checksum of each file below /etc, target of each link that is a setting."""
    lines = run("find /etc -xdev -type f -exec sha256sum {} +").splitlines()
    files = {path: checksum for checksum, path in (line.split(maxsplit=1) for line in lines) if not OWN.fullmatch(path)}
    return files | {"/etc/localtime": run("readlink /etc/localtime || true")}


def packages(run: Callable[[str], str]) -> set[str]:
    lines = run("dpkg-query --show --showformat '${Package} ${db:Status-Status}\\n'").splitlines()
    return {line.split()[0] for line in lines if not line.endswith("config-files")}


def forget(robot: Machine) -> None:
    """The new host has another SSH key."""
    subprocess.run(["ssh-keygen", "-q", "-R", robot.address, "-f", str(FOLDER / "known_hosts")], check=True)
