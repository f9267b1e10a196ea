"""A host leaves the fleet, and another takes its place."""

import json
import re
import signal
import subprocess
from collections.abc import Callable

from tests.support.fleet import Machine
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.rehearsal import FOLDER, Playbook, Rehearsal, ask_from, docker

Measured = Callable[[str], None]

# What is different on each host, or is left by Debian's packages when they are purged: backups. The setting of chrony
# is the rehearsal's own, for a package that the host has not got yet.
OWN = re.compile(
    r"/etc/(machine-id|ssh/ssh_host_.*|resolv\.conf|hosts|hostname|ld\.so\.cache|.*-|\.pwd\.lock|mailcap|.*/\.wh\..*"
    r"|default/chrony)"
)


def test_a_host_is_torn_down_and_replaced_by_another_whose_deploy_is_broken_off(
    rehearsal: Rehearsal, measured: Measured
) -> None:
    robot = rehearsal.robots[1]
    rehearsal.playbook("teardown", f"--limit={robot.name}")
    measured("torn down")
    left = settings(robot), packages(robot)
    of_others = set(robot.run("apt-mark showauto").split())
    reach = f"import socket; socket.create_connection(('{robot.address}', 22), 5).close(); print('reached')"
    assert ask_from("laserbot-fleet", reach).strip() == "reached", "there is no firewall any more"

    # another Raspberry Pi with a fresh card
    docker("rm", "--force", "--volumes", f"laserbot-fleet-{robot.name}")
    docker("volume", "rm", f"laserbot-fleet-{robot.name}")
    forget(robot)
    subprocess.run([str(ROOT / "ci" / "fleet-hosts"), "up"], check=True)
    until(lambda: robot.host.run("true").rc == 0, 60, "the old host's connection is given up")
    fresh = settings(robot), packages(robot)
    assert left[0] == fresh[0]
    assert fresh[1] <= left[1]
    assert left[1] - fresh[1] <= of_others, "libraries that packages of the host recommend may stay"

    measured("")
    first = Playbook("deploy")
    first.wait_for("TASK [host : Install the packages of all hosts]", 120)
    first.stop(signal.SIGINT, 60)
    measured("broken off")
    run = rehearsal.playbook("deploy")
    measured("run again to its end")
    assert run.recap[robot.name]["changed"] > 10
    release = json.loads(robot.run("cat /etc/laserbot/release.json"))
    assert release["current"] == rehearsal.robots[0].container("laserbot-robot")["Config"]["Image"]
    rehearsal.wait_until_complete()
    measured("all robots play")


def settings(machine: Machine) -> dict[str, str]:
    """Checksum of each file below /etc."""
    lines = machine.run("find /etc -xdev -type f -exec sha256sum {} +").splitlines()
    return {path: checksum for checksum, path in (line.split(maxsplit=1) for line in lines) if not OWN.fullmatch(path)}


def packages(machine: Machine) -> set[str]:
    lines = machine.run("dpkg-query --show --showformat '${Package} ${db:Status-Status}\\n'").splitlines()
    return {line.split()[0] for line in lines if not line.endswith("config-files")}


def forget(robot: Machine) -> None:
    """The new host has another SSH key."""
    subprocess.run(["ssh-keygen", "-q", "-R", robot.address, "-f", str(FOLDER / "known_hosts")], check=True)
