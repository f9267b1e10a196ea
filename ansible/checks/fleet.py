"""A deployed fleet: its hosts over SSH, and the battle that is played on it."""

import asyncio
import base64
import contextlib
import functools
import json
import os
import shlex
import socket
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import testinfra
import yaml
from testinfra.host import Host

from laser_bot_battle import search, variables

SERVICES = {
    "master": [
        "laserbot-rosmaster",
        "laserbot-rosbridge",
        "laserbot-web",
        "laserbot-camera-relay",
        "laserbot-rosout",
        "laserbot-backup",
        "laserbot-front",
        "laserbot-bots",
        "laserbot-announcer",
    ],
    "robots": ["laserbot-robot"],
}
CAMERA_SERVICE = "laserbot-camera"
OVERHEAD_SERVICE = "laserbot-overhead"
_ROLES = Path(__file__).parent.parent / "roles"
_MASTER, _ROBOT = (yaml.safe_load((_ROLES / f"{role}/vars/main.yml").read_text()) for role in ("master", "robot"))
# The Python modules of services that an older release may lack (roles/release); the core is not among them.
MODULES = {
    service["name"]: service["command"][2]
    for service in (*_MASTER["master_services"], *_MASTER["master_overhead"], _ROBOT["robot_camera_service"])
    if service["name"] not in _MASTER["master_core"]
}
# As roles/release asks: a module of a package that is not there is not there either.
LACKING = (
    "import importlib.util as u, sys; print(*[module for module in sys.argv[1:] if not all("
    "u.find_spec(module.rsplit('.', i)[0]) for i in range(module.count('.'), -1, -1))])"
)


@dataclass(frozen=True)
class Machine:
    """A host of the inventory."""

    name: str
    group: str  # master or robots
    address: str
    user: str
    ssh: str  # options of ssh: the key, where host keys are kept
    serial: str = "/dev/laserbot"
    platform: str = ""  # the image's, where it is not the host's own
    camera: bool = False  # whether the robot has one
    overhead: bool = False  # whether the master has one above the floor
    tls: bool = False  # whether the master's front has a certificate
    monitoring: bool = False  # whether Prometheus watches the master
    arena: str = "laser-bot-master"  # the name by which the master announces itself
    open_ports: tuple[int, ...] = ()  # that the operator has opened besides the game's
    checked: bool = True  # whether the operator asks for checks of it

    @property
    def services(self) -> list[str]:
        """What the inventory asks for."""
        extras = {CAMERA_SERVICE: self.camera, OVERHEAD_SERVICE: self.overhead}
        return SERVICES[self.group] + [service for service, is_there in extras.items() if is_there]

    @functools.cached_property
    def left_out(self) -> list[str]:
        """Those of them for which the image that it runs, of an older release, has no program."""
        modules = {service: MODULES[service] for service in self.services if service in MODULES}
        if not modules:
            return []
        ask = ["docker", "exec", self.services[0], "python3", "-c", LACKING, *modules.values()]
        lacking = self.run(shlex.join(ask)).split()
        return [service for service, module in modules.items() if module in lacking]

    @property
    def running(self) -> list[str]:
        """The services that should run."""
        return [service for service in self.services if service not in self.left_out]

    @functools.cached_property
    def host(self) -> Host:
        """The host for testinfra, as root."""
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

    @property
    def registry_password(self) -> str:
        """The one that its engine has been given."""
        entry = json.loads(self.run("cat /root/.docker/config.json"))["auths"]["laser-bot-master.local:5443"]
        return base64.b64decode(entry["auth"]).decode().partition(":")[2]

    def container(self, service: str) -> dict[str, Any]:
        """What the engine says of a container."""
        return self.containers(service)[service]

    def containers(self, *services: str) -> dict[str, dict[str, Any]]:
        """The same of several, by default of all that should run."""
        found = json.loads(self.run(f"docker inspect {' '.join(services or self.running)}"))
        return {container["Name"].removeprefix("/"): container for container in found}

    def run_in_containers(self, command: str) -> dict[str, str]:
        """What a command prints in each of the services' containers, all at once."""
        each = f"echo $s $(docker exec $s {command} 2>&1)"
        lines = self.run(f"for s in {' '.join(self.running)}; do {each} & done; wait").splitlines()
        return {service: said for service, _, said in (line.partition(" ") for line in lines)}


class Fleet:
    """A master and robots, and where the battle is."""

    def __init__(self, machines: Iterable[Machine]) -> None:
        self.machines = {machine.name: machine for machine in machines}
        (self.master,) = (machine for machine in self.machines.values() if machine.group == "master")
        self.robots = [machine for machine in self.machines.values() if machine.group == "robots"]

    @classmethod
    def read(cls, file: Path, sockets: Path) -> "Fleet":
        """The fleet that ansible/check.yml has written down.

        All commands to a host share one connection; ssh keeps its socket in the folder `sockets`.
        """
        hosts = json.loads(file.read_text())
        for name, host in hosts.items():
            given = host["address"] or (master_address(host["arena"]) if host["group"] == "master" else "")
            host["address"] = resolved(given or f"{name}.local")
            host["ssh"] += f" -o ControlPath={sockets}/%C"
        return cls(Machine(name, **host) for name, host in hosts.items())

    @property
    def web(self) -> str:
        return f"http://{self.master.address}:5000"

    @property
    def bridge(self) -> str:
        return f"ws://{self.master.address}:9090"


def master_address(arena: str) -> str:
    """Of a master whose address is not in the inventory: LASERBOT_MASTER, else where that arena announces itself, else
    ""."""
    given = variables.MASTER.read(os.environ)
    if given:
        return given
    with contextlib.suppress(OSError):  # there is no network, or no multicast; TimeoutError is one
        return asyncio.run(_announced_address(arena))
    return ""


async def _announced_address(arena: str) -> str:
    """The firewall keeps this machine from the ROS master: whether that answers does not count."""
    async with search.searching(arena) as heard, asyncio.timeout(search.LISTEN):
        while not (claims := heard.named(arena)):
            await heard.news.wait()
            heard.news.clear()
        return claims[-1].addresses[0]


def resolved(name: str) -> str:
    """The address of that name; of a host that is off, the name itself."""
    with contextlib.suppress(OSError):
        return socket.gethostbyname(name)
    return name


def until(condition: Callable[..., bool], seconds: float, what: str) -> None:
    """Ask until it is so; AssertionError after `seconds`."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"not within {seconds:.0f} s: {what}"
        time.sleep(0.2)
