"""A battle and a master of a LAN are started in three ways (roslaunch, compose, Kubernetes): by the same programs."""

import re
import shlex
from collections import Counter
from collections.abc import Callable, Mapping
from typing import NamedTuple

import pytest
import roslaunch.config
import yaml

from tests.support.imagefile import dockerfile
from tests.support.manifests import Kubelet, Manifests, Object, overlay
from tests.support.programs import ROOT

# for two robots and a bot
PROGRAMS = {
    "server.ros.master": 1,
    "server.main": 1,
    "server.rosbridge": 1,
    "server.camera": 1,
    "server.ros.rosout": 1,
    "sim.arena": 1,
    "avr_robot": 2,
    "robot.id_service_client": 2,
    "server.bots": 1,
    "sim.positions": 1,
}
# where multicast passes
ANNOUNCED = {"server.announcer": 1}
ROSOUT = {"server.ros.rosout": 1}  # a lab's roscore, with which roslaunch is used, has one already
FRONT = {"server.front": 1}  # needs a port of root's; in a cluster it is a component
BOTS = {"server.bots": 1}
MASTER_OF_A_LAN = {"server.ros.master": 1, "server.main": 1, "server.rosbridge": 1, "server.camera": 1, **ANNOUNCED}


class Start(NamedTuple):
    """How one program is started."""

    command: list[str]
    environment: Mapping[str, str]

    @property
    def program(self) -> str:
        return self.command[2] if self.command[:2] == ["python3", "-m"] else self.command[0].rpartition("/")[2]

    def option(self, name: str) -> str:
        return self.command[self.command.index(name) + 1]


def launched(file: str, *arguments: str) -> list[Start]:
    path = str(next(ROOT.glob(f"*/launch/{file}.launch")))
    launch = roslaunch.config.load_config_default([(path, list(arguments))], 11311, assign_machines=False)
    nodes = [Start(shlex.split(node.args), dict(node.env_args)) for node in launch.nodes]
    return [Start(["python3", "-m", "server.ros.master"], {}), *nodes]  # roscore or sim/demo.py starts the master


def composed(profile: str) -> list[Start]:
    services = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"].values()
    found = []
    for service in services:
        if profile in service["profiles"]:
            image = re.findall(r"(\w+):\$", service["image"])[0]
            command = service.get("command") or dockerfile(image).command
            found.append(Start(command, service.get("environment", {})))
    return found


def in_pods(manifests: Manifests, workloads: list[Object]) -> list[Start]:
    found = []
    addresses = {"master": "10.43.0.1", "arena": "10.43.0.2"}
    for workload in workloads:
        name, pod = workload["metadata"]["name"], workload["spec"]["template"]["spec"]
        for number in range(workload["spec"]["replicas"]):
            fields = {"metadata.name": f"{name}-{number}", "status.podIP": "10.42.0.7"}
            kubelet = Kubelet(manifests, pod, fields, addresses)
            found += [Start(kubelet.command(each), kubelet.environment(each)) for each in pod["containers"]]
    return found


def by_roslaunch() -> list[Start]:
    return launched("demo", "robots:=2", "run_dir:=/run")


def by_compose() -> list[Start]:
    return composed("demo")


def by_kubernetes() -> list[Start]:
    return in_pods(overlay("sim"), overlay("sim").workloads)


every_description = pytest.mark.parametrize("describe", [by_roslaunch, by_compose, by_kubernetes])


@pytest.fixture(autouse=True)
def package_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(ROOT))


@every_description
def test_it_starts_every_program_and_no_other(describe: Callable[[], list[Start]]) -> None:
    more = ANNOUNCED if describe is by_roslaunch else {}
    assert Counter(start.program for start in describe()) == {**PROGRAMS, **more}


@pytest.mark.parametrize(
    ("starts", "more"),
    [
        pytest.param(lambda: launched("master"), BOTS, id="roslaunch"),
        pytest.param(lambda: composed("master"), {**FRONT, **ROSOUT, **BOTS}, id="compose"),
        pytest.param(
            lambda: in_pods(overlay("lan"), [overlay("lan").one("Deployment", "master")]),
            {**ROSOUT, **BOTS},
            id="kubernetes",
        ),
    ],
)
def test_a_lans_master_starts_every_program_and_no_other(
    starts: Callable[[], list[Start]], more: dict[str, int]
) -> None:
    assert Counter(start.program for start in starts()) == {**MASTER_OF_A_LAN, **more}


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
