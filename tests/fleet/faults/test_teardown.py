"""The hosts are left as they were, and make a fleet again."""

import contextlib
import json
import shlex
import threading
from collections.abc import Callable, Iterator

import psutil
import pytest

from fleet import Machine
from tests.support.card import card_of, packages, settings
from tests.support.rehearsal import Rehearsal, ask_from

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]
ENGINE = {"docker.io", "docker-cli"}  # one package in Debian 12


def test_a_fleet_is_torn_down_and_comes_back(rehearsal: Rehearsal, measured: Measured) -> None:
    give_an_engine_from_before(rehearsal.master)
    rehearsal.master.run("touch /var/lib/laserbot/robots.json")
    measured("")
    rehearsal.playbook("teardown")
    measured("torn down")
    rehearsal.master.run("rm /var/lib/laserbot/robots.json")  # it is still there
    rehearsal.playbook("teardown", "--extra-vars=data=remove")
    take_engine_from_before(rehearsal.master)
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

    dry = rehearsal.playbook("deploy", "--check", "--diff")
    assert all(row["failed"] == 0 for row in dry.recap.values())
    measured("")
    with command_lines() as shown:
        run = rehearsal.playbook("deploy", "--diff")
    measured("deployed again")
    rehearsal.wait_until_complete()
    for secret in (
        rehearsal.master.run("cat /etc/laserbot/operator-token").strip(),
        rehearsal.master.registry_password,
    ):
        assert secret
        assert secret not in run.output
        assert not [line for line in shown if secret in line]


@contextlib.contextmanager
def command_lines() -> Iterator[set[str]]:
    """Those of all processes that are seen meanwhile, here and on the hosts, which are containers of this machine."""
    seen: set[str] = set()
    over = threading.Event()

    def look() -> None:
        while not over.wait(0.1):
            seen.update("\0".join(process.info["cmdline"] or ()) for process in psutil.process_iter(["cmdline"]))

    thread = threading.Thread(target=look)
    thread.start()
    try:
        yield seen
    finally:
        over.set()
        thread.join()
    assert [line for line in seen if "skopeo" in line], "what runs on the hosts is seen"


def give_an_engine_from_before(machine: Machine) -> None:
    """The host had an engine before its first deploy, and a container in it that is none of the fleet's."""
    note = json.loads(machine.run("cat /etc/laserbot/before.json"))
    note["packages"] += sorted(ENGINE & packages(machine.run))
    machine.run(f"sh -c {shlex.quote(f'echo {shlex.quote(json.dumps(note))} >/etc/laserbot/before.json')}")
    machine.run(f"docker tag {machine.container(machine.services[0])['Image']} own:1")
    machine.run("docker run --detach --name own --restart always --network none --entrypoint sleep own:1 infinity")


def take_engine_from_before(machine: Machine) -> None:
    """It has gone on, and knows nothing of the fleet any more; now it goes, too."""
    assert machine.run("docker ps --all --format '{{.Names}}'").split() == ["own"]
    assert machine.run("docker image ls --format '{{.Repository}}:{{.Tag}}'").split() == ["own:1"]
    assert machine.run("find /etc/docker -type f").split() in ([], ["/etc/docker/key.json"])
    assert json.loads(machine.run("cat /root/.docker/config.json"))["auths"] == {}
    machine.run("docker rm --force own")
    machine.run("docker image rm own:1")
    machine.run(f"apt-get purge --autoremove --yes {' '.join(ENGINE & packages(machine.run))}")
    machine.run("groupdel docker")
    machine.run("rm -r /etc/docker /root/.docker")
