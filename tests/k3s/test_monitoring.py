"""components/monitoring: Prometheus and Alertmanager beside the master's programs, and no battle needs them."""

import os
import re
import subprocess
from pathlib import Path

import pytest
import requests
import yaml

from laser_bot_battle.names import WATCHED
from tests.integration.test_monitoring import unpacked
from tests.k3s.test_front import container_of, environment_of, pod_of
from tests.support.imagefile import dockerfile, version
from tests.support.manifests import Manifests, overlay
from tests.support.ports import free_port
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT, Program

OURS = ROOT / "monitoring"
README = (ROOT / "k3s/README.md").read_text()
PORTS = {"prometheus": 9210, "alertmanager": 9211}


@pytest.fixture(params=["lan+monitoring", "sim+monitoring"])
def manifests(request: pytest.FixtureRequest) -> Manifests:
    return overlay(request.param).within("laserbot")


@pytest.fixture(params=PORTS)
def watcher(request: pytest.FixtureRequest) -> str:
    """The name of each of the two containers."""
    return str(request.param)


def test_the_programs_tell_where_prometheus_asks_and_nobody_else(manifests: Manifests) -> None:
    (job,) = yaml.safe_load((OURS / "prometheus.yml").read_text())["scrape_configs"]
    asked = {each["labels"]["program"]: each["targets"] for each in job["static_configs"]}
    for name, program in {"web": "web", "rosbridge": "rosbridge", "camera-relay": "relay"}.items():
        command = container_of(manifests, name)["command"]
        settings = ProgramSettings(command, environment_of(manifests, name)).settings
        assert settings is not None
        address, port = settings.program.metrics
        assert address == "127.0.0.1"
        assert asked[program] == [f"{address}:{port + WATCHED.index(program)}"]


def test_nobody_reaches_them_but_by_a_forwarded_port(manifests: Manifests, watcher: str) -> None:
    container, port = container_of(manifests, watcher), PORTS[watcher]
    assert f"--web.listen-address=127.0.0.1:{port}" in " ".join(container["command"]).split()
    assert "ports" not in container
    assert f"port-forward deployment/master {' '.join(map(str, PORTS.values()))}" in README


def test_they_ask_nothing_of_the_battle(manifests: Manifests, watcher: str) -> None:
    """A pod is ready when all its containers are: these are as soon as they run."""
    container = container_of(manifests, watcher)
    assert {key for key in container if key.endswith("Probe")} == {"livenessProbe"}
    alive = container["livenessProbe"]
    assert alive["exec"]["command"] == dockerfile("monitoring").health
    assert alive["periodSeconds"] * (alive["failureThreshold"] - 1) >= 60, "a slow program is not restarted"
    assert alive["timeoutSeconds"] >= 10
    for service in manifests.of("Service"):
        if service["spec"]["selector"] == {"app.kubernetes.io/name": "master"}:
            assert service["spec"]["publishNotReadyAddresses"], "the game goes on while one of them is started again"


def test_what_they_keep_has_room_enough(manifests: Manifests) -> None:
    """More than an emptyDir may hold would end the pod, and with it the game's programs."""
    volumes = {volume["name"]: volume for volume in pod_of(manifests)["volumes"]}
    (kept,) = re.findall(r"retention.size=(\d+)GB", " ".join(container_of(manifests, "prometheus")["command"]))
    assert int(volumes["prometheus"]["emptyDir"]["sizeLimit"].removesuffix("Gi")) >= 2 * int(kept)
    for name in PORTS:
        container = container_of(manifests, name)
        (written,) = [mount for mount in container["volumeMounts"] if not mount.get("readOnly")]
        assert "emptyDir" in volumes[written["name"]]
        assert written["mountPath"] in re.findall(r"storage\S*path=(\S+)", " ".join(container["command"]))


def test_their_image_is_of_this_version(manifests: Manifests, watcher: str) -> None:
    container = container_of(manifests, watcher)
    assert (container["image"], container["imagePullPolicy"]) == (f"monitoring:{version()}", "IfNotPresent")


def test_prometheus_runs_by_its_command(tmp_path: Path) -> None:
    """Debian's, as the image has it, but for its port and folders."""
    port = free_port()
    places = {"9210": str(port), "/opt/laserbot/monitoring": str(OURS), "/var/lib/prometheus": str(tmp_path)}
    _, *words = container_of(overlay("sim+monitoring").within("laserbot"), "prometheus")["command"]
    for there, place in places.items():
        words = [word.replace(there, place) for word in words]
    program = Program([str(unpacked("prometheus") / "usr/bin/prometheus"), *words])
    try:
        program.wait_for("Server is ready")
        rules = requests.get(f"http://127.0.0.1:{port}/api/v1/rules", timeout=10).json()["data"]["groups"]
        assert [group["name"] for group in rules] == ["laserbot"]
    finally:
        program.stop()


def test_alertmanager_takes_the_operators_configuration_if_there_is_one(tmp_path: Path) -> None:
    """A word that only says its arguments stands for Alertmanager, which needs files of its package in /usr."""
    manifests = overlay("sim+monitoring").within("laserbot")
    container = container_of(manifests, "alertmanager")
    (secret,) = [volume["secret"] for volume in pod_of(manifests)["volumes"] if "secret" in volume]
    assert secret == {"secretName": "alertmanager", "optional": True}
    assert "create secret generic alertmanager --from-file=alertmanager.yml" in README
    (folder,) = [mount["mountPath"] for mount in container["volumeMounts"] if mount.get("readOnly")]
    (tmp_path / "prometheus-alertmanager").symlink_to("/bin/echo")
    command = [word.replace(folder, str(tmp_path)) for word in container["command"]]

    def arguments() -> list[str]:
        path = f"{tmp_path}:{os.environ['PATH']}"
        result = subprocess.run(command, env={"PATH": path}, capture_output=True, text=True, check=True)
        return result.stdout.split()

    assert arguments()[0] == "--config.file=/opt/laserbot/monitoring/alertmanager.yml"
    (tmp_path / "alertmanager.yml").touch()
    assert arguments()[0] == f"--config.file={tmp_path}/alertmanager.yml"
    program = unpacked("prometheus-alertmanager") / "usr/bin/prometheus-alertmanager"
    known = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    for option in arguments():
        assert option.partition("=")[0] in known
