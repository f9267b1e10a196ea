"""A deployed fleet: its hosts over SSH, and the battle that is played on it."""

import functools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import testinfra
from testinfra.host import Host

MASTER = "laser_bot_master"
SERVICES = {"master": ["laserbot-rosmaster", "laserbot-rosbridge", "laserbot-web"], "robots": ["laserbot-robot"]}


@dataclass(frozen=True)
class Machine:
    """A host of the inventory."""

    name: str
    group: str  # master or robots
    address: str
    user: str
    ssh: str  # options of ssh: the key, where host keys are kept

    @property
    def services(self) -> list[str]:
        return SERVICES[self.group]

    @functools.cached_property
    def host(self) -> Host:
        """The host for testinfra, as root; all share one connection."""
        return testinfra.get_host(
            f"ssh://{self.user}@{self.address}",
            sudo=True,
            ssh_extra_args=f"{self.ssh} -o ConnectTimeout=5",
            controlpersist=30,
        )

    def run(self, command: str) -> str:
        """What a command of root's prints; AssertionError with its complaint if it fails."""
        result = self.host.run(command)
        assert result.rc == 0, f"{self.name}: {command}: {result.stdout}{result.stderr}"
        return str(result.stdout)

    def container(self, service: str) -> dict[str, Any]:
        """What the engine says of a container."""
        return dict(json.loads(self.run(f"docker inspect {service}"))[0])


class Fleet:
    """The hosts that a file names (written by ci/fleet-hosts or ansible/check.yml), and where the battle is."""

    def __init__(self, file: Path) -> None:
        self.machines = {name: Machine(name, **host) for name, host in json.loads(file.read_text()).items()}
        self.master = self.machines[MASTER]
        self.robots = [machine for machine in self.machines.values() if machine.group == "robots"]

    @property
    def web(self) -> str:
        return f"http://{self.master.address}:5000"

    @property
    def bridge(self) -> str:
        return f"ws://{self.master.address}:9090"
