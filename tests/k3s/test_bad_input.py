"""What an operator is told when something is wrong, and that the documents have the words that are really said."""

import os
import re
import socket
import subprocess
import sys
import threading
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest
import yaml

from tests.k3s.conftest import Customize
from tests.support.documents import kubernetes_pages
from tests.support.imagefile import version
from tests.support.manifests import Kubelet, Object, overlay
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program

PYTHONPATH = f"{ROOT}:{ROOT / 'build/python'}"
TEXT = kubernetes_pages()
OVERLAY = "".join(path.read_text() for path in (ROOT / "k3s/overlays/lan").glob("*.yaml"))


def quoted(words: str) -> bool:
    """Whether a row of the table quotes these words."""
    return any(words in line for line in TEXT.splitlines() if line.startswith("| "))


def run(environment: Mapping[str, str], command: list[str]) -> str:
    """What the container's program says before it refuses."""
    program = {"python3": sys.executable, "avr_robot": str(ROOT / "build/sim/avr_robot")}[command[0]]
    words = [word.replace("/opt/laserbot/firmware", str(ROOT / "build/firmware")) for word in command[1:]]
    path = {"PATH": os.environ["PATH"], "PYTHONPATH": f"{ROOT}:{ROOT / 'build/python'}"}
    result = subprocess.run(
        [program, *words],
        cwd=ROOT,
        env={**path, **environment},
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert result.returncode == 2, result.stderr
    return result.stderr


def container_of(workload: Object, name: str) -> tuple[Object, Object]:
    pod: Object = workload["spec"]["template"]["spec"]
    (container,) = [each for each in pod["containers"] if each["name"] == name]
    return pod, container


@pytest.mark.parametrize(
    ("name", "setting", "words"),
    [
        ("settings", "LASERBOT_HIT_DAMAGE=lots", "LASERBOT_HIT_DAMAGE=lots: must be a whole number from 1 to 100"),
        ("settings", "LASERBOT_ROSTER=raspberrypi1", "'raspberrypi1' is not name=ID with an ID from 0 to 127"),
        ("logging", "LASERBOT_LOG_LEVEL=loud", "LASERBOT_LOG_LEVEL=loud: must be one of debug, info, warning, error"),
    ],
)
def test_a_wrong_value_in_the_kustomization_is_named_by_the_program(
    customize: Customize, name: str, setting: str, words: str
) -> None:
    generator = {"name": name, "namespace": "laserbot", "behavior": "merge", "literals": [setting]}
    manifests = customize("lan", configMapGenerator=[generator]).within("laserbot")
    pod, web = container_of(manifests.one("Deployment", "master"), "web")
    kubelet = Kubelet(manifests, pod, {"status.podIP": "127.0.0.1"}, {})
    assert words in run(kubelet.environment(web), kubelet.command(web))
    assert quoted(words)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("robot", "LASERBOT_WEB_PORT=$(MASTER_SERVICE_PORT_WEB): must be a whole number"),
        ("arduino", "--arena $(ARENA_SERVICE_HOST):$(ARENA_SERVICE_PORT_LINK): the port must be a whole number"),
    ],
)
def test_a_pod_without_the_services_says_which_address_is_missing(name: str, words: str) -> None:
    manifests = overlay("sim").within("laserbot")
    pod, container = container_of(manifests.one("StatefulSet", "robot"), name)
    kubelet = Kubelet(manifests, pod, {"status.podIP": "127.0.0.1", "metadata.name": "robot-0"}, {})
    assert words in run(kubelet.environment(container), kubelet.command(container))
    assert quoted(words)


def test_a_robot_without_arduino_says_where_it_looked() -> None:
    manifests = overlay("lan").within("laserbot")
    pod, container = container_of(manifests.one("DaemonSet", "robot"), "robot")
    fields = {"spec.nodeName": "raspberrypi1", "status.hostIP": "127.0.0.1"}
    environment = Kubelet(manifests, pod, fields, {"master": "127.0.0.1"}).environment(container)
    program = Program.python("robot.id_service_client", env={**environment, "PYTHONPATH": PYTHONPATH})
    try:
        program.wait_for("No attached ARDUINO found: looked for /host/dev/laserbot")
    finally:
        program.stop()
    assert quoted("No attached ARDUINO found: looked for /host/dev/laserbot")


def test_a_port_that_is_taken_is_named() -> None:
    with socket.socket() as taken:
        taken.bind(("0.0.0.0", 0))
        taken.listen()
        number = taken.getsockname()[1]
        environment = {"LASERBOT_WEB_PORT": str(number), "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
        program = Program.python("server.main", env={**environment, "PYTHONPATH": PYTHONPATH})
        program.wait_for(f"cannot listen on 0.0.0.0 port {number}")
        assert program.exit_code() == 1
    assert quoted("cannot listen on 0.0.0.0 port 5000")


def test_a_program_that_is_no_ros_master_is_named() -> None:
    with HTTPServer(("127.0.0.1", 0), BaseHTTPRequestHandler) as other:
        thread = threading.Thread(target=other.serve_forever)
        thread.start()
        address = f"localhost:{other.server_port}"
        environment = {"LASERBOT_WEB_PORT": str(free_port()), "ROS_MASTER_URI": f"http://{address}"}
        program = Program.python("server.main", env={**environment, "PYTHONPATH": PYTHONPATH})
        try:
            program.wait_for(f"does not answer as a ROS master: <ProtocolError for {address}/RPC2: 501")
        finally:
            program.stop()
            other.shutdown()
            thread.join()
    assert quoted("does not answer as a ROS master: <ProtocolError for localhost:11311/RPC2: 501")


def test_a_component_without_its_ports_is_refused(tmp_path: Path) -> None:
    up = os.path.relpath(ROOT / "k3s", tmp_path)
    content = {"resources": [f"{up}/overlays/lan"], "components": [f"{up}/components/node-ports"]}
    (tmp_path / "kustomization.yaml").write_text(yaml.safe_dump(content))
    words = [str(ROOT / "ci/kubectl"), "kustomize", str(tmp_path)]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert "node-ports" in result.stderr


def test_the_image_in_the_table_is_of_this_version() -> None:
    assert quoted(f'Failed to pull image "rosberry:{version()}"')


COMMANDS = [
    words
    for line in re.findall(r"^kubectl .*|`kubectl [^`]*", TEXT, re.MULTILINE)
    if len(words := line.strip("`").split("#")[0].split()) > 3
]


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_what_a_command_of_the_readme_names_is_there(words: list[str]) -> None:
    """No cluster is here to run it: its overlays, objects, namespaces and labels are looked for in the manifests."""
    overlays = ("sim", "lan+front+monitoring", "arenas+leaderboard")
    objects = [item for name in overlays for item in overlay(name).objects]
    names = {(item["kind"].lower(), item["metadata"]["name"]) for item in objects}
    pairs = [tuple(word.split("/")) for word in words if re.fullmatch(r"[a-z]+/[a-z]+", word)]
    if words[-2] == "service":
        pairs.append((words[-2], words[-1]))
    for pair in pairs:
        assert pair in names
    if "-k" in words:
        assert (ROOT / words[words.index("-k") + 1] / "kustomization.yaml").exists()
    if "-n" in words:
        assert ("namespace", words[words.index("-n") + 1]) in names
    for word in words:
        if word.startswith("laserbot/"):
            assert f"laserbot/role: {word.partition('=')[2]}" in OVERLAY or word.endswith("-")


def test_every_address_in_the_readme_is_one_of_the_manifests() -> None:
    for name in ("sim", "arenas"):
        for service in overlay(name).of("Service"):
            for port in service["spec"].get("ports", []):
                if port.get("targetPort") in {"web", "view"} and "nodePort" in port:
                    assert str(port["nodePort"]) in TEXT
    ports = {port["targetPort"]: port for port in overlay("sim").one("Service", "players")["spec"]["ports"]}
    forwards = [f"{ports[name]['nodePort']}:{ports[name]['port']}" for name in ("web", "rosbridge", "relay")]
    assert f"port-forward service/players {' '.join(forwards)}" in TEXT
