"""compose.yaml's profiles master, overhead, monitoring and robot: a battle without any typed address, and who watches
it.

A machine is a container that only holds the network and the host name; what compose would start on the host's network
starts on that one.
"""

import json
import os
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Self

import pytest
import requests
import yaml

from tests.support import avr
from tests.support.containers import engine, execute, remove
from tests.support.play import shoot_to_the_end, start
from tests.support.player import Eyes, Player
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program

pytestmark = pytest.mark.slow

AVAHI = Path("/run/avahi-daemon")
SERVICES = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"]
ADDRESSES = {"LASERBOT_MASTER", "ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME"}


class Machine:
    """Runs `docker compose up` for profiles, words, with these settings; a context manager that ends it."""

    def __init__(self, name: str, network: str, profiles: str, folder: Path, version: str, **settings: str) -> None:
        self._holder = engine().containers.run(
            f"webserver:{version}", ["sleep", "infinity"], detach=True, hostname=name, network=network
        )
        self._holder.reload()
        self.address = str(self._holder.attrs["NetworkSettings"]["Networks"][network]["IPAddress"])
        hosts = {
            service: {"network_mode": f"container:{self._holder.id}"}
            for service, description in SERVICES.items()
            if description["profiles"][0] in profiles.split()
        }
        assert all(SERVICES[service]["network_mode"] == "host" for service in hosts)
        override = folder / f"{name}.yaml"
        override.write_text(json.dumps({"services": hosts}))  # JSON is YAML
        self._services = set(hosts)
        self._options = ["--env-file=/dev/null", f"--project-name=laserbot-{name}-{os.getpid()}"]
        self._options += [f"--profile={profile}" for profile in profiles.split()]
        self._options += ["--file", str(ROOT / "compose.yaml"), "--file", str(override)]
        outside = {name: value for name, value in os.environ.items() if name not in ADDRESSES}
        self._environment: Mapping[str, str] = {**outside, "LASERBOT_VERSION": version, **settings}

    def compose(self, *words: str) -> str:
        command = ["docker", "compose", *self._options, *words]
        result = subprocess.run(command, env=self._environment, capture_output=True, text=True, check=False)
        assert result.returncode == 0, f"{' '.join(command)}: {result.stdout}{result.stderr}"
        return result.stdout

    def wait_until_healthy(self) -> None:
        def healthy() -> bool:
            rows = [json.loads(line) for line in self.compose("ps", "--all", "--format", "json").splitlines()]
            return {row["Service"]: row["Health"] for row in rows} == dict.fromkeys(self._services, "healthy")

        try:
            until(healthy, 90, f"{self._services} are healthy")
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.compose('logs')}") from None

    def read(self, url: str) -> Any:
        """The JSON that a program on this machine gives only to those on it."""
        ask = f"from urllib.request import urlopen; print(urlopen('{url}', timeout=10).read().decode())"
        return json.loads(execute(self._holder, "python3", "-c", ask))

    def __enter__(self) -> Self:
        try:
            self.compose("up", "--detach", "--pull=never", "--no-build")
        except AssertionError:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.compose("down", "--volumes", "--timeout", "5")
        remove([self._holder])


class Battle:
    """The master's machine, seen from the network, and the arena that the Arduinos are in."""

    def __init__(self, master: Machine, arena_port: int) -> None:
        self.web = f"http://{master.address}:5000"
        self.bridge = f"ws://{master.address}:9090"
        self.view = f"ws://127.0.0.1:{arena_port}/view"


@pytest.fixture
def network(version: str) -> Iterator[str]:
    """One that passes multicast, as an engine's internal network does not."""
    made = engine().networks.create(f"laserbot-lan-{os.getpid()}")
    yield str(made.name)
    made.remove()


@pytest.fixture
def avahi_folder() -> Iterator[None]:
    """The engine makes the folder where there is none."""
    had_avahi = AVAHI.exists()
    yield
    if not had_avahi:
        AVAHI.rmdir()


@pytest.fixture
def arena() -> Iterator[tuple[int, int]]:
    """The ports of its view and of the Arduinos' link."""
    view, link = free_port(), free_port()
    ports = {"LASERBOT_ARENA_PORT": str(view), "LASERBOT_ARENA_LINK_PORT": str(link)}
    program = Program.python("sim.arena", env={"LASERBOT_BIND": "127.0.0.1", **ports})
    yield view, link
    program.stop()


@pytest.fixture
def serial_devices(arena: tuple[int, int], tmp_path: Path) -> Iterator[list[str]]:
    """Two virtual Arduinos' devices, which the group of serial devices may open (as udev would have it)."""
    avr.build()
    with ExitStack() as stack:
        devices = []
        for number in (1, 2):
            link = tmp_path / f"arduino{number}"
            words = ["--firmware", str(avr.FIRMWARE), "--name", f"raspberrypi{number}", "--serial", str(link)]
            program = Program([str(avr.AVR_ROBOT), *words, "--arena", f"127.0.0.1:{arena[1]}"])
            stack.callback(program.stop)
            program.wait_for("UART at")
            device = os.readlink(link)
            os.chown(device, -1, 20)  # dialout, in every Debian
            os.chmod(device, 0o660)
            devices.append(device)
        yield devices


@pytest.mark.usefixtures("avahi_folder")
def test_robots_find_the_master_and_a_battle_is_played(
    version: str, network: str, arena: tuple[int, int], serial_devices: list[str], tmp_path: Path
) -> None:
    rules = {"LASERBOT_HIT_DAMAGE": "40", "LASERBOT_COUNTDOWN": "1", "LASERBOT_ROSTER": "raspberrypi1=1 raspberrypi2=2"}
    with ExitStack() as stack:
        robots = []
        for number, device in enumerate(serial_devices, 1):
            name = f"raspberrypi{number}"
            settings = {"LASERBOT_ROBOT_NAME": name, "LASERBOT_SERIAL": f"/host/dev/ttyACM0 /host{device}"}
            robots.append(stack.enter_context(Machine(name, network, "robot", tmp_path, version, **settings)))
        until(lambda: all("no arena announces itself" in robot.compose("logs") for robot in robots), 60, "robots look")
        master = stack.enter_context(Machine("hall", network, "master", tmp_path, version, **rules))
        for machine in (master, *robots):
            machine.wait_until_healthy()
        assert all("'hall'" in robot.compose("logs") for robot in robots), "an arena has its master's host name"
        battle = Battle(master, arena[0])

        def free() -> int:
            return int(requests.post(f"{battle.web}/getAvailableRobots", timeout=LATEST).json()["availableR"])

        until(lambda: free() == 2, 30, "two free robots")
        with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob, Eyes(battle) as eyes:
            assert (ann.robot, bob.robot) == (1, 2)
            start(ann, bob)
            assert shoot_to_the_end(ann, bob, eyes) == [100, 60, 20, 0]


@pytest.mark.usefixtures("avahi_folder")
def test_a_program_that_stops_is_an_alert(version: str, network: str, tmp_path: Path) -> None:
    camera = "http://127.0.0.1:9/stream"  # nothing is there: the tracker goes on asking
    with Machine(
        "hall", network, "master overhead monitoring", tmp_path, version, LASERBOT_OVERHEAD_CAMERA=camera
    ) as hall:

        def up() -> dict[str, str]:
            answer = hall.read("http://127.0.0.1:9210/api/v1/query?query=up")
            return {series["metric"]["program"]: series["value"][1] for series in answer["data"]["result"]}

        def alerts() -> list[str]:
            return [alert["annotations"]["summary"] for alert in hall.read("http://127.0.0.1:9211/api/v2/alerts")]

        hall.wait_until_healthy()
        programs = "web", "rosbridge", "relay", "overhead"
        until(lambda: up() == dict.fromkeys(programs, "1"), 30, "Prometheus has asked all of them")
        hall.compose("stop", "camera-relay")
        until(lambda: "relay does not answer." in alerts(), 90, "Alertmanager has heard of it")


def test_alertmanager_takes_a_file_of_the_operators(version: str, network: str, tmp_path: Path) -> None:
    own = tmp_path / "own.yml"
    own.write_text((ROOT / "monitoring/alertmanager.yml").read_text().replace("operators", "my_phone"))
    with Machine("hall", network, "monitoring", tmp_path, version, LASERBOT_ALERTMANAGER=str(own)) as hall:
        hall.wait_until_healthy()
        status = hall.read("http://127.0.0.1:9211/api/v2/status")
        assert "my_phone" in status["config"]["original"]
