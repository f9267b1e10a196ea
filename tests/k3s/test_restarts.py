"""What a battle needs is replaced after its end: a roll-out, a drained node and a scaled-down robot wait for it."""

import os
import subprocess
from pathlib import Path

import pytest

from laser_bot_battle.variables import BATTLE_LIMIT
from tests.k3s.conftest import Customize
from tests.k3s.test_containers import Started
from tests.support.documents import kubernetes_pages
from tests.support.manifests import Manifests, Object, overlay
from tests.support.programs import ROOT

MODULE = "laser_bot_battle.restarting"
CASES = [
    (name, namespace, pod, container)
    for name in ("lan+front", "sim+front", "arenas")
    for namespace in overlay(name).namespaces
    for pod, container in overlay(name).within(namespace).containers
]
every_container = pytest.mark.parametrize(
    ("name", "namespace", "pod", "container"),
    CASES,
    ids=[f"{name}-{namespace}-{container['name']}" for name, namespace, _, container in CASES],
)


def asked(command: list[str], environment: dict[str, str], folder: Path) -> list[str]:
    """What the hook's command starts, in the place of a container."""
    stand_in = folder / "python3"
    stand_in.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    stand_in.chmod(0o755)
    environment = {**environment, "PATH": f"{folder}:{os.environ['PATH']}", "HOSTNAME": "raspberrypi1"}
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return run.stdout.splitlines()


@every_container
def test_it_waits_for_the_end_of_its_battle(
    name: str, namespace: str, pod: Object, container: Object, tmp_path: Path
) -> None:
    started = Started(name, namespace, pod, container)
    command = container["lifecycle"]["preStop"]["exec"]["command"]
    assert pod["terminationGracePeriodSeconds"] > BATTLE_LIMIT.default
    words = asked(command, started.environment, tmp_path)
    is_masters = "web" in {each["name"] for each in pod["containers"]}
    url = "http://localhost:5000" if is_masters else f"http://{started.addresses['master']}:5000"
    robot = started.environment.get("LASERBOT_ROBOT_NAME") or started.environment.get("NAME")
    assert words == ["-m", MODULE, url, *(["--robot", robot] if robot else [])]
    assert (ROOT / f"laser_bot_battle/src/{MODULE.replace('.', '/')}.py").exists()


@every_container
def test_what_hangs_in_a_battle_is_restarted_at_once(name: str, namespace: str, pod: Object, container: Object) -> None:
    for probe in ("startupProbe", "livenessProbe"):
        if probe in container:
            assert container[probe]["terminationGracePeriodSeconds"] <= 5


def test_a_robots_camera_waits_with_it(customize: Customize, tmp_path: Path) -> None:
    pod = customize("lan", "camera").one("DaemonSet", "robot")["spec"]["template"]["spec"]
    (camera,) = [each for each in pod["containers"] if each["name"] == "camera"]
    known = {"MASTER_SERVICE_HOST": "10.43.0.1", "MASTER_SERVICE_PORT_WEB": "5000"}
    command = camera["lifecycle"]["preStop"]["exec"]["command"]
    assert asked(command, known, tmp_path) == ["-m", MODULE, "http://10.43.0.1:5000", "--robot", "raspberrypi1"]


def test_no_budget_keeps_the_only_node_from_being_drained_for_ever(manifests: Manifests) -> None:
    # without these options it ends at once, as there are such pods
    assert "`kubectl drain NODE --ignore-daemonsets --delete-emptydir-data`" in kubernetes_pages()
    # the second robot would wait for the first one, which has no other node to be ready at
    assert not manifests.of("PodDisruptionBudget")
