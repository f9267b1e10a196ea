"""The rehearsed fleet (ci/fleet-hosts): what a person with hands does to its hosts, and their arena."""

import contextlib
import os
import tarfile
import time
from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import Self

import requests
import yaml
from docker.models import containers

from fleet import Fleet, Machine
from tests.support.containers import engine, execute
from tests.support.local_play import recap
from tests.support.polling import until
from tests.support.programs import ROOT, Program

FOLDER = ROOT / "build" / "fleet"
INVENTORY = FOLDER / "inventory" / "hosts.yml"
SSH = f"-i {FOLDER / 'key'} -o UserKnownHostsFile={FOLDER / 'known_hosts'}"
ARENA = "10.217.0.2"
PLAIN = {"ANSIBLE_STRATEGY": "linear", "ANSIBLE_TIMEOUT": "10"}  # Ansible's own


class Rehearsal(Fleet):
    """The fleet together with the machine that it is rehearsed on."""

    view = f"ws://{ARENA}:8080/view"

    def __init__(self) -> None:
        groups = yaml.safe_load(INVENTORY.read_text())
        super().__init__(
            Machine(name, group, host["ansible_host"], "pi", SSH, camera="robot_camera" in host, tls=group == "master")
            for group in ("master", "robots")
            for name, host in groups[group]["hosts"].items()
        )

    def playbook(self, name: str, *arguments: str, check: bool = True) -> "Playbook":
        """Runs a playbook to its end, by Mitogen if that is asked for (ci/fleet)."""
        manner = {setting: os.environ.get(setting, own) for setting, own in PLAIN.items()}
        return Playbook(name, *arguments, manner=manner).finish(check)

    def available(self) -> int:
        """Robots that are free now; -1 while the server does not answer."""
        with contextlib.suppress(requests.RequestException, ValueError):
            return int(requests.post(f"{self.web}/getAvailableRobots", timeout=2).json()["availableR"])
        return -1

    def wait_until_complete(self, seconds: float = 300.0) -> None:
        """Until every robot is registered and free."""
        until(lambda: self.available() == len(self.robots), seconds, "all robots free at the server")


class Playbook(Program):
    """A playbook under way, as operators run it. By Mitogen it would neither end when it is broken off nor give up a
    host that is lost."""

    def __init__(self, name: str, *arguments: str, manner: Mapping[str, str] = PLAIN) -> None:
        self.started = time.monotonic()
        super().__init__(
            [
                str(ROOT / ".venv" / "bin" / "ansible-playbook"),
                str(ROOT / "ansible" / f"{name}.yml"),
                f"--inventory={FOLDER / 'inventory'}",
                f"--vault-password-file={FOLDER / 'vault-password'}",
                *arguments,
            ],
            {
                "ANSIBLE_CONFIG": str(ROOT / "ansible" / "ansible.cfg"),
                "ANSIBLE_NOCOLOR": "1",
                **manner,
            },
        )

    def finish(self, check: bool = True) -> Self:
        """Wait for its end; with `check` it must succeed."""
        code = self.process.wait(1800)
        self.seconds = time.monotonic() - self.started
        assert code == 0 or not check, self.output
        return self

    @property
    def recap(self) -> dict[str, dict[str, int]]:
        """ok, changed, failed, unreachable ... of each host."""
        return recap(self.output)

    @property
    def changed(self) -> int:
        return sum(row["changed"] for row in self.recap.values())


def outside(machine: Machine) -> containers.Container:
    """The container that plays the host, in the engine of the machine that rehearses."""
    name = "master" if machine.group == "master" else machine.name
    return engine().containers.get(f"laserbot-fleet-{name}")


def copy_into(machine: Machine, source: Path, path: str) -> None:
    with BytesIO() as packed:
        with tarfile.open(fileobj=packed, mode="w") as archive:
            archive.add(source, Path(path).name)
        outside(machine).put_archive(str(Path(path).parent), packed.getvalue())


def power_off(machine: Machine) -> None:
    """As if the plug were pulled."""
    outside(machine).kill()


def power_on(machine: Machine) -> None:
    outside(machine).start()


@contextlib.contextmanager
def cut(machine: Machine, share: int = 100) -> Iterator[None]:
    """The host's network loses `share` percent of what arrives and leaves, SSH from this machine included.

    The virtual Arduino's link to the arena is spared: it stands for wheels and light, which need no network.
    """
    some = f"numgen random mod 100 < {share}" if share < 100 else ""
    rules = "; ".join(
        f"add chain inet cut {hook} {{ type filter hook {hook} priority -300; }}; "
        f"add rule inet cut {hook} ip {end} {ARENA} accept; "
        f"add rule inet cut {hook} {side} != lo {some} drop"
        for hook, side, end in (("input", "iifname", "saddr"), ("output", "oifname", "daddr"))
    )
    execute(outside(machine), "nft", f"add table inet cut; {rules}")
    try:
        yield
    finally:
        execute(outside(machine), "nft", "delete table inet cut")


def ask_from(network: str, program: str) -> str:
    """What a Python program prints that runs in a place of its own on a network: a player's laptop."""
    image = engine().containers.get("laserbot-fleet-arena").attrs["Config"]["Image"]
    said: bytes = engine().containers.run(image, ["-c", program], entrypoint="python3", remove=True, network=network)
    return said.decode()
