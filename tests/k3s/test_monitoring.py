"""Prometheus and Alertmanager beside the game (components/monitoring), which does without them; and what there is for a
Prometheus of the cluster's own (components/metrics, components/prometheus-operator)."""

import os
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest
import requests
import yaml

from laser_bot_battle.names import WATCHED
from tests.integration.test_monitoring import unpacked
from tests.k3s.conftest import Customize
from tests.k3s.test_front import container_of as of_master
from tests.k3s.test_front import environment_of
from tests.support.crds import is_custom, problems
from tests.support.documents import kubernetes_pages
from tests.support.imagefile import dockerfile, version
from tests.support.manifests import Kubelet, Manifests, Object, overlay
from tests.support.polling import LATEST
from tests.support.ports import free_port
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT, Program

OURS = ROOT / "monitoring"
README = kubernetes_pages()
PORTS = {"prometheus": 9210, "alertmanager": 9211}
PROGRAMS = {"web": "web", "rosbridge": "rosbridge", "camera-relay": "relay", "overhead": "overhead"}  # by container


def pod_of(manifests: Manifests) -> Object:
    return dict(manifests.one("Deployment", "monitoring")["spec"]["template"]["spec"])


def container_of(manifests: Manifests, name: str) -> Object:
    (found,) = [each for each in pod_of(manifests)["containers"] if each["name"] == name]
    return dict(found)


@pytest.fixture(params=["lan+monitoring+overhead", "sim+overhead+monitoring"])
def manifests(request: pytest.FixtureRequest) -> Manifests:
    return overlay(request.param).within("laserbot")


@pytest.fixture(params=PORTS)
def watcher(request: pytest.FixtureRequest) -> str:
    """The name of each of the two containers."""
    return str(request.param)


def told(manifests: Manifests) -> dict[str, tuple[str, int]]:
    """Where the master's programs can be watched: the port's name and number, by program."""
    found = {}
    for name, program in PROGRAMS.items():
        container = of_master(manifests, name)
        settings = ProgramSettings(container["command"], environment_of(manifests, name)).settings
        assert settings is not None
        address, first = settings.program.metrics
        assert address == "0.0.0.0"
        number = first + WATCHED.index(program)
        (port,) = [each["name"] for each in container["ports"] if each["containerPort"] == number]
        found[program] = (port, number)
    return found


def test_the_service_metrics_leads_to_every_program(manifests: Manifests) -> None:
    service = manifests.one("Service", "metrics")
    assert service["spec"]["selector"] == {"app.kubernetes.io/name": "master"}
    led = {(port["targetPort"], port["port"]) for port in service["spec"]["ports"]}
    assert led == set(told(manifests).values())
    assert service["metadata"]["annotations"] == {"prometheus.io/scrape": "true"}


def test_the_tracker_is_watched_only_where_the_others_are() -> None:
    manifests = overlay("lan+overhead").within("laserbot")
    assert "LASERBOT_METRICS" not in environment_of(manifests, "overhead")


def test_nobody_reaches_them_but_by_a_forwarded_port(manifests: Manifests, watcher: str) -> None:
    container, port = container_of(manifests, watcher), PORTS[watcher]
    assert f"--web.listen-address=127.0.0.1:{port}" in " ".join(container["command"]).split()
    assert "ports" not in container
    assert f"port-forward deployment/monitoring {' '.join(map(str, PORTS.values()))}" in README


def test_they_outlive_the_masters_node(manifests: Manifests) -> None:
    pod = pod_of(manifests)
    assert "tolerations" not in pod, "of a lost node it is moved away, as any pod is"
    assert not pod.get("hostNetwork")
    (apart,) = pod["affinity"]["podAntiAffinity"]["preferredDuringSchedulingIgnoredDuringExecution"]
    assert apart["podAffinityTerm"]["topologyKey"] == "kubernetes.io/hostname"
    labels = manifests.one("Deployment", "master")["spec"]["template"]["metadata"]["labels"]
    assert apart["podAffinityTerm"]["labelSelector"]["matchLabels"].items() <= labels.items()


def test_they_ask_nothing_of_the_battle(manifests: Manifests, watcher: str) -> None:
    container = container_of(manifests, watcher)
    assert {key for key in container if key.endswith("Probe")} == {"livenessProbe"}
    alive = container["livenessProbe"]
    assert alive["exec"]["command"] == dockerfile("monitoring").health
    assert alive["periodSeconds"] * (alive["failureThreshold"] - 1) >= 60, "a slow program is not restarted"
    assert alive["timeoutSeconds"] >= 10
    names = {each["name"] for each in manifests.one("Deployment", "master")["spec"]["template"]["spec"]["containers"]}
    assert not names & set(PORTS), "and no change of theirs restarts the master"


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


def test_prometheus_runs_by_its_command_and_asks_the_master(tmp_path: Path) -> None:
    """Debian's, as the image has it, but for its port and folders."""
    manifests = overlay("sim+monitoring+overhead").within("laserbot")
    kubelet = Kubelet(manifests, pod_of(manifests), {}, {"metrics": "10.43.0.9"})
    container, port = container_of(manifests, "prometheus"), free_port()
    places = {"9210": str(port), "/opt/laserbot/monitoring": str(OURS), "/var/lib/prometheus": str(tmp_path)}
    words = kubelet.command(container)
    for there, place in places.items():
        words = [word.replace(there, place) for word in words]
    path = f"{unpacked('prometheus') / 'usr/bin'}:{os.environ['PATH']}"
    program = Program(words, {**kubelet.environment(container), "PATH": path})
    try:
        program.wait_for("Server is ready")
        ask = f"http://127.0.0.1:{port}/api/v1"
        rules = requests.get(f"{ask}/rules", timeout=LATEST).json()["data"]["groups"]
        assert [group["name"] for group in rules] == ["laserbot"]
        config = yaml.safe_load(requests.get(f"{ask}/status/config", timeout=LATEST).json()["data"]["yaml"])
        (job,) = config["scrape_configs"]
        asked = {each["labels"]["program"]: each["targets"] for each in job["static_configs"]}
        assert asked == {name: [f"10.43.0.9:{number}"] for name, (_, number) in told(manifests).items()}
        assert f"127.0.0.1:{PORTS['alertmanager']}" in str(config["alerting"])
    finally:
        program.stop()


def test_a_pod_that_is_older_than_the_service_says_so() -> None:
    manifests = overlay("sim+monitoring").within("laserbot")
    kubelet = Kubelet(manifests, pod_of(manifests), {}, {})
    container = container_of(manifests, "prometheus")
    result = subprocess.run(kubelet.command(container), env={}, capture_output=True, text=True, check=False)
    assert result.returncode != 0
    assert "the Service metrics is younger than this pod" in result.stderr


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


@cache
def operated() -> Manifests:
    return overlay("sim+prometheus-operator+overhead").within("laserbot")


def test_the_operators_objects_fit_its_definitions() -> None:
    custom = [item for item in operated().objects if is_custom(item)]
    assert {item["kind"] for item in custom} == {"PodMonitor", "PrometheusRule"}
    assert problems(*custom) == []
    monitor = operated().one("PodMonitor", "master")
    wrong = {**monitor, "spec": {**monitor["spec"], "podMetricEndpoints": []}}
    assert problems(wrong) == ["spec.podMetricEndpoints is no field"]


def test_the_operator_asks_every_program_under_the_labels_of_the_alerts() -> None:
    spec = operated().one("PodMonitor", "master")["spec"]
    labels = operated().one("Deployment", "master")["spec"]["template"]["metadata"]["labels"]
    assert spec["selector"]["matchLabels"].items() <= labels.items()
    (job,) = yaml.safe_load((OURS / "prometheus.yml").read_text())["scrape_configs"]
    asked = {}
    for endpoint in spec["podMetricsEndpoints"]:
        given = {each["targetLabel"]: each["replacement"] for each in endpoint["relabelings"]}
        assert given["job"] == job["job_name"]
        asked[given["program"]] = endpoint["port"]
    assert asked == {program: port for program, (port, _) in told(operated()).items()}
    assert set(asked) == {each["labels"]["program"] for each in job["static_configs"]}


def test_the_operator_has_the_same_alerts() -> None:
    rules = operated().one("PrometheusRule", "laserbot")["spec"]
    assert rules == yaml.safe_load((OURS / "rules.yml").read_text())


def test_each_arena_of_a_cluster_is_watched_in_its_own_namespace(customize: Customize) -> None:
    manifests = customize("arenas/made/red", "prometheus-operator", namespace="laserbot-red")
    assert {item["metadata"].get("namespace", "laserbot-red") for item in manifests.objects} == {"laserbot-red"}
