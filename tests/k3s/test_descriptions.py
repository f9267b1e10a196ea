"""A battle is described three times for starting (roslaunch, compose, Kubernetes): each has the same programs."""

import re
import shlex
from collections import Counter
from collections.abc import Callable, Mapping
from typing import NamedTuple

import pytest
import roslaunch.config
import yaml

from tests.support.imagefile import dockerfile
from tests.support.manifests import Kubelet, overlay
from tests.support.programs import ROOT

# for two robots and a bot
PROGRAMS = {
    "rosmaster": 1,
    "server.main": 1,
    "server.rosbridge": 1,
    "sim.arena": 1,
    "avr_robot": 2,
    "robot.id_service_client": 2,
    "sim.bot": 1,
}


class Start(NamedTuple):
    """How one program is started."""

    command: list[str]
    environment: Mapping[str, str]

    @property
    def program(self) -> str:
        return self.command[2] if self.command[:2] == ["python3", "-m"] else self.command[0].rpartition("/")[2]

    def option(self, name: str) -> str:
        return self.command[self.command.index(name) + 1]


def by_roslaunch() -> list[Start]:
    file = str(next(ROOT.glob("*/launch/demo.launch")))
    arguments = ["robots:=2", "bots:=1", "run_dir:=/run"]
    launch = roslaunch.config.load_config_default([(file, arguments)], 11311, assign_machines=False)
    nodes = [Start(shlex.split(node.args), dict(node.env_args)) for node in launch.nodes]
    return [Start(["rosmaster"], {}), *nodes]  # sim/demo.py starts the master


def by_compose() -> list[Start]:
    services = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"].values()
    found = []
    for service in services:
        if "demo" in service["profiles"]:
            image = re.findall(r"(\w+):\$", service["image"])[0]
            command = service.get("command") or dockerfile(image).command
            found.append(Start(command, service.get("environment", {})))
    return found


def by_kubernetes() -> list[Start]:
    manifests, found = overlay("sim"), []
    addresses = {"master": "10.43.0.1", "arena": "10.43.0.2"}
    for workload in manifests.workloads:
        name, pod = workload["metadata"]["name"], workload["spec"]["template"]["spec"]
        for number in range(workload["spec"]["replicas"]):
            fields = {"metadata.name": f"{name}-{number}", "status.podIP": "10.42.0.7"}
            kubelet = Kubelet(manifests, pod, fields, addresses)
            found += [Start(kubelet.command(each), kubelet.environment(each)) for each in pod["containers"]]
    return found


every_description = pytest.mark.parametrize("describe", [by_roslaunch, by_compose, by_kubernetes])


@pytest.fixture(autouse=True)
def package_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(ROOT))


@every_description
def test_it_starts_every_program_and_no_other(describe: Callable[[], list[Start]]) -> None:
    assert Counter(start.program for start in describe()) == PROGRAMS


@every_description
def test_every_robot_has_its_name_its_arduino_and_its_place_in_the_arena(describe: Callable[[], list[Start]]) -> None:
    starts = describe()
    arduinos = {start.option("--name"): start for start in starts if start.program == "avr_robot"}
    robots = {
        start.environment["LASERBOT_ROBOT_NAME"]: start.environment["LASERBOT_SERIAL"]
        for start in starts
        if start.program == "robot.id_service_client"
    }
    assert len(arduinos) == 2
    assert arduinos.keys() == robots.keys()
    for name, arduino in arduinos.items():
        line = arduino.option("--serial" if "--serial" in arduino.command else "--tcp")
        assert robots[name].endswith(line.partition(":")[2] or line)
        assert arduino.option("--firmware").endswith("firmware/laserbot.elf")
        assert arduino.option("--arena").endswith(":8081")
