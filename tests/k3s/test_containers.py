"""Every container of the manifests against its image and its program."""

import math
import os
import re
import subprocess
import sys
from functools import cache

import pytest

from tests.support.imagefile import dockerfile, folders
from tests.support.manifests import REFERENCE, Kubelet, Manifests, Object, overlay
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT

FIELDS = {
    "metadata.name": "robot-0",
    "spec.nodeName": "raspberrypi1",
    "status.podIP": "10.42.0.7",
    "status.hostIP": "192.0.2.7",
}
WITH_MORE = ("lan+front+monitoring+overhead", "sim+front+monitoring")
CASES = [
    (name, namespace, pod, container)
    for name in ("lan", "sim", "arenas", *WITH_MORE)
    for namespace in overlay(name).namespaces
    for pod, container in overlay(name).within(namespace).containers
]


def each_of(cases: list[tuple[str, str, Object, Object]]) -> pytest.MarkDecorator:
    ids = [f"{name}-{namespace}-{container['name']}" for name, namespace, _, container in cases]
    return pytest.mark.parametrize(("name", "namespace", "pod", "container"), cases, ids=ids)


every_container = each_of([case for case in CASES if not case[3]["image"].startswith("monitoring:")])
also_those_of_others = each_of(CASES)


class Started:
    """A container as the kubelet would start it."""

    def __init__(self, name: str, namespace: str, pod: Object, container: Object) -> None:
        self.manifests: Manifests = overlay(name).within(namespace)
        services = self.manifests.of("Service")
        self.addresses = {item["metadata"]["name"]: f"10.43.0.{number}" for number, item in enumerate(services, 1)}
        kubelet = Kubelet(self.manifests, pod, FIELDS, self.addresses)
        self.pod, self.container = pod, container
        self.environment = kubelet.environment(container)
        self.command = kubelet.command(container)
        self.image: str = container["image"].partition(":")[0]
        self.settings = ProgramSettings(self.command, self.environment)
        self.given = {item["name"] for item in container.get("env", [])}
        for source in container.get("envFrom", []):
            self.given |= set(self.manifests.one("ConfigMap", source["configMapRef"]["name"]).get("data", ()))

    def memory(self, what: str) -> int:
        """MiB of its `requests` or `limits`."""
        return int(self.container["resources"][what]["memory"].removesuffix("Mi"))


@pytest.fixture
def started(name: str, namespace: str, pod: Object, container: Object) -> Started:
    return Started(name, namespace, pod, container)


@every_container
def test_the_command_is_a_program_of_the_image(started: Started) -> None:
    program = started.command[0]
    if program == "python3":
        module = started.command[2]
        assert module.split(".")[0] in folders(started.image)
        path = ROOT / module.replace(".", "/")
        assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file()
    else:
        assert (program, started.image) == ("avr_robot", "sim")


@every_container
def test_the_program_knows_its_options(started: Started) -> None:
    options = [word for word in started.command if re.fullmatch(r"--[a-z]+", word) or word == "-p"]
    if not options:
        return
    known = usage(*started.command[: 3 if started.command[0] == "python3" else 1])
    for option in options:
        assert option in known


@cache
def usage(program: str, *arguments: str) -> str:
    """The program's --help."""
    here = {
        "python3": [sys.executable],
        "avr_robot": [str(ROOT / "build/sim/avr_robot")],
    }
    words = [*here[program], *arguments, "--help"]
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}/build/python"}
    return subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True, check=True).stdout


@every_container
def test_the_program_reads_every_variable_and_accepts_its_value(started: Started) -> None:
    in_command = {name for word in started.container["command"] for name in REFERENCE.findall(word)}
    assert started.given <= started.settings.variables | in_command


@every_container
def test_an_overlay_can_say_how_a_program_logs(started: Started) -> None:
    if started.command[0] == "python3":  # the Arduino's has no log of ours
        read = {source["configMapRef"]["name"].rpartition("-")[0] for source in started.container["envFrom"]}
        assert read & {"logging", "robot", "arena", "positions", "bot"}


@pytest.mark.parametrize("name", ["lan", "sim", "arenas", "lan+camera"])
def test_a_setting_restarts_only_what_reads_it(name: str) -> None:
    """Two workloads never read the same ConfigMap."""
    for namespace in overlay(name).namespaces:
        readers: dict[str, set[str]] = {}
        for workload in overlay(name).within(namespace).workloads:
            for config in re.findall(r"'configMap(?:Key)?Ref': {[^}]*'name': '([^']+)'", str(workload)):
                readers.setdefault(config, set()).add(workload["metadata"]["name"])
        assert readers
        assert [config for config, names in readers.items() if len(names) > 1] == []


@every_container
def test_every_reference_is_resolved(started: Started) -> None:
    for text in (*started.command, *started.environment.values()):
        assert not REFERENCE.search(text)


@every_container
def test_its_ports_are_those_that_the_program_listens_at(started: Started) -> None:
    named = {port["name"]: port["containerPort"] for port in started.container.get("ports", [])}
    assert set(named.values()) == started.settings.ports
    if started.container["name"] != "front":  # whose own ports are root's
        own = {number for name, number in named.items() if not name.startswith("metrics-")}
        assert own <= dockerfile(started.image).ports


@also_those_of_others
def test_its_user_is_the_images_user(started: Started) -> None:
    rights = started.pod["securityContext"]
    assert f"{rights['runAsUser']}:{rights['runAsGroup']}" == dockerfile(started.image).user
    assert rights["fsGroup"] == rights["runAsGroup"]


@every_container
def test_what_the_image_writes_to_is_a_volume_and_no_other(started: Started) -> None:
    image = dockerfile(started.image)
    mounts = {mount["mountPath"]: mount for mount in started.container["volumeMounts"]}
    volumes = {volume["name"]: volume for volume in started.pod["volumes"]}
    run = image.environment["ROS_HOME"]
    assert image.environment["ROS_LOG_DIR"] == run, "ROS would give a folder that it makes there the volume's owner"
    assert "emptyDir" in volumes[mounts[run]["name"]]
    writable = {path for path, mount in mounts.items() if not mount.get("readOnly")}
    data = {image.environment["LASERBOT_DATA"]} if "LASERBOT_DATA" in started.settings.variables else set()
    assert writable == {run} | data


@pytest.mark.parametrize("name", ["lan", "sim", "arenas", *WITH_MORE])
def test_every_volume_is_used_by_one_container(name: str) -> None:
    for workload in overlay(name).workloads:
        pod = workload["spec"]["template"]["spec"]
        used = [mount["name"] for container in pod["containers"] for mount in container["volumeMounts"]]
        assert sorted(used) == sorted(volume["name"] for volume in pod["volumes"])


@every_container
def test_its_probes_are_cheap_and_ask_the_service_itself(started: Started) -> None:
    probes = {key: value for key, value in started.container.items() if key.endswith("Probe")}
    assert "readinessProbe" in probes
    for probe in probes.values():
        if "exec" in probe:
            assert probe["exec"]["command"] == dockerfile(started.image).health
            # process 1 is then the pod's, and the check could not tell which program it is asked about
            assert not started.pod.get("shareProcessNamespace")
        else:
            port = (probe.get("httpGet") or probe["tcpSocket"])["port"]
            assert port in {item["name"] for item in started.container["ports"]}
        assert probe["timeoutSeconds"] >= 10


@every_container
def test_a_slow_program_is_not_restarted(started: Started) -> None:
    alive = started.container.get("livenessProbe")
    if alive:
        assert alive["periodSeconds"] * (alive["failureThreshold"] - 1) >= 60
    ready = started.container["readinessProbe"]
    assert ready.get("periodSeconds", 10) <= 10, "a program that works again is seen soon"


@pytest.mark.parametrize("name", ["lan", "sim", "arenas"])
def test_each_service_of_the_master_has_all_three_probes(name: str) -> None:
    for namespace in overlay(name).namespaces:
        master = overlay(name).within(namespace).one("Deployment", "master")
        containers = master["spec"]["template"]["spec"]["containers"]
        # a pod's own network passes no multicast; and beside virtual robots, bots have a pod of their own
        more = {"announcer", "bots"} if name == "lan" else set()
        assert {container["name"] for container in containers} == {
            "ros-master",
            "rosbridge",
            "web",
            "camera-relay",
            "rosout",
        } | more
        for container in containers:
            assert {"startupProbe", "readinessProbe", "livenessProbe"} <= set(container)


@also_those_of_others
def test_the_last_words_of_a_program_are_in_its_pods_description(started: Started) -> None:
    assert started.container["terminationMessagePolicy"] == "FallbackToLogsOnError"


@also_those_of_others
def test_its_resources_are_bounded(started: Started) -> None:
    resources = started.container["resources"]
    assert set(resources["requests"]) == set(resources["limits"]) == {"cpu", "memory"}


# MiB that the programs have used at most in battles: on a cluster of two nodes, in the containers of the pods here, and
# in the demo, with a page that shows what the robots see
PEAKS = {"robot": 75, "arduino": 21, "web": 135, "rosbridge": 61, "ros-master": 53, "bot": 51}
PEAKS |= {"front": 31, "positions": 54}
PEAKS |= {"arena": 112, "camera-relay": 48, "overhead": 77, "rosout": 43, "bots": 34, "announcer": 31}


@every_container
def test_it_asks_for_the_memory_that_it_needs_and_a_fifth_or_a_bit_more(started: Started) -> None:
    peak = PEAKS[started.container["name"]]
    assert math.ceil(1.2 * peak) <= started.memory("requests") <= 1.5 * peak


@also_those_of_others
def test_it_may_use_twice_the_memory_that_it_asks_for(started: Started) -> None:
    assert 2 * started.memory("requests") <= started.memory("limits")


def test_virtual_robots_have_the_ids_that_are_painted_on_them() -> None:
    settings = overlay("sim").config("settings")
    (web,) = [container for _, container in overlay("sim").containers if container["name"] == "web"]
    read = ProgramSettings(web["command"], settings.get("data", {}))
    assert read.settings is not None
    robots = overlay("sim").one("StatefulSet", "robot")
    expected = {f"/id_service_client_{robots['metadata']['name']}_{number}": number for number in range(8)}
    assert read.settings.roster == expected


def test_virtual_robots_play_with_coded_light() -> None:
    settings = overlay("sim").config("settings")
    (web,) = [container for _, container in overlay("sim").containers if container["name"] == "web"]
    read = ProgramSettings(web["command"], settings.get("data", {}))
    assert read.settings is not None
    assert read.settings.rules.light == "coded"


def test_a_virtual_robot_is_its_pod() -> None:
    """Its Arduino is in the arena, and its software known to the server, by the name of the pod."""
    manifests = overlay("sim")
    pod = manifests.one("StatefulSet", "robot")["spec"]["template"]["spec"]
    addresses = {"master": "10.43.0.1", "arena": "10.43.0.2"}
    kubelet = Kubelet(manifests, pod, FIELDS | {"metadata.name": "robot-1"}, addresses)
    arduino, robot = pod["containers"]
    words = kubelet.command(arduino)
    assert words[words.index("--name") + 1] == "robot-1"
    environment = kubelet.environment(robot)
    assert environment["LASERBOT_ROBOT_NAME"] == "robot-1"
    assert environment["LASERBOT_CAMERA_URL"] == "http://10.43.0.2:8080/eyes/robot-1"
    assert environment["LASERBOT_SERIAL"] == f"socket://{words[words.index('--tcp') + 1]}"
    assert words[words.index("--firmware") + 1].startswith("/opt/laserbot/firmware/")
