"""The manifests of k3s/ with the real images: each pod as a kubelet would run it, without any name service."""

import json
import os
import stat
import subprocess
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
import requests

from tests.support.documents import kubernetes_pages
from tests.support.manifests import Manifests, customized, overlay
from tests.support.play import PLAYING, a_bot_waits, shoot_to_the_end
from tests.support.player import Eyes, Front, Player
from tests.support.pods import ClusterBattle, Pod, free_node_ports, merged
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def manifests(version: str, tmp_path_factory: pytest.TempPathFactory) -> Manifests:
    """The sim overlay as an operator changes it: with a front and monitoring, other ports, and short rules."""
    ports = [
        {"op": "add", "path": f"/spec/ports/{number}/nodePort", "value": free_port()} for number in range(2)
    ]  # http, https
    built = customized(
        tmp_path_factory.mktemp("kustomization"),
        "sim",
        "node-ports",
        "front",
        "monitoring",
        configMapGenerator=[free_node_ports(), merged("settings", "LASERBOT_HIT_DAMAGE=40", "LASERBOT_COUNTDOWN=1")],
        patches=[{"target": {"kind": "Service", "name": "front"}, "patch": json.dumps(ports)}],
    )
    assert {container["image"].split(":")[1] for _, container in built.containers} == {version}
    return built.within("laserbot")


@pytest.fixture(scope="module")
def battle(manifests: Manifests, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClusterBattle]:
    with ClusterBattle(manifests, tmp_path_factory.mktemp("cluster")) as running:
        running.wait_until_ready()
        yield running


def test_every_container_passes_every_probe_and_none_has_ended(battle: ClusterBattle) -> None:
    assert sorted(battle.pods) == ["arena", "bot", "master", "monitoring", "robot-0", "robot-1"]
    for pod in battle.pods.values():
        for container in pod.spec["containers"]:
            for probe in [key for key in container if key.endswith("Probe")]:
                asked = f"{pod.name}/{container['name']} {probe}"
                until(partial(pod.passes, container["name"], probe), 30, asked)
            assert pod.state(container["name"])["Running"]
            assert pod.exec(container["name"], "id", "-u").strip() == "10001"


def test_a_person_plays_against_the_bot_to_the_end(battle: ClusterBattle) -> None:
    with Player(battle, "Ann") as ann, Eyes(battle) as eyes:
        page = ann.http.get(f"{battle.web}/home", timeout=LATEST).text
        assert f'name="rosbridge-port" content="{battle.rosbridge_port}"' in page
        assert {robot["name"]: robot["id"] for robot in eyes.robots().values()} == {"robot-0": 0, "robot-1": 1}
        assert ann.ready() == "OK"
        ann.wait_for_game(PLAYING, 30)
        shoot_to_the_end(ann, 1 - ann.robot, eyes)
        result = {entry["name"]: entry["life"] for entry in ann.look()["result"]}
        assert set(result) == {"Ann", "Bot1"}
        assert min(result.values()) == 0


def test_the_front_is_the_one_address_of_it_all(battle: ClusterBattle) -> None:
    host = f"127.0.0.1:{battle.node_ports['http']}"
    place = Front(host, battle.view)
    with Player(place, "Cleo") as cleo, Eyes(place) as eyes:
        until(lambda: cleo.user().get("robot") in eyes.robots(), 10, "rosbridge answers there")


def test_a_secret_gives_the_front_tls_from_its_next_start_on(battle: ClusterBattle) -> None:
    secret = battle.folder / "master/secrets/front"
    secret.mkdir(parents=True)
    name = "-subj /CN=localhost -addext subjectAltName=DNS:localhost"
    words = f"openssl req -x509 -newkey rsa:2048 -nodes -keyout tls.key -out tls.crt -days 2 {name}"
    subprocess.run(words.split(), cwd=secret, check=True, capture_output=True)
    master = battle.pods["master"]
    master.start_container("front", battle.manifests, battle.addresses)
    until(partial(master.passes, "front", "readinessProbe"), 60, "the front is back")
    secure = f"https://localhost:{battle.node_ports['https']}"
    assert requests.get(f"{secure}/watch", verify=str(secret / "tls.crt"), timeout=LATEST).ok
    plain = f"http://127.0.0.1:{battle.node_ports['http']}/watch"
    told = requests.get(plain, headers={"Host": "arena.example"}, timeout=LATEST, allow_redirects=False)
    assert told.headers["Location"] == "https://arena.example/watch"


def test_prometheus_hears_every_program_and_tells_alertmanager(battle: ClusterBattle) -> None:
    monitoring = battle.pods["monitoring"]

    def heard() -> set[str]:
        result = monitoring.read("http://127.0.0.1:9210/api/v1/query?query=up==1")["data"]["result"]
        return {series["metric"]["program"] for series in result}

    until(lambda: heard() == {"web", "rosbridge", "relay"}, 30, "all programs are heard")
    (alertmanager,) = monitoring.read("http://127.0.0.1:9210/api/v1/alertmanagers")["data"]["activeAlertmanagers"]
    assert alertmanager["url"].startswith("http://127.0.0.1:9211/")
    assert monitoring.read("http://127.0.0.1:9211/api/v2/status")["config"]["original"]


def test_a_prometheus_that_ends_is_started_again_alone(battle: ClusterBattle) -> None:
    battle.pods["monitoring"].kill("prometheus")
    assert requests.post(f"{battle.web}/updateGameStatus", timeout=LATEST).ok
    assert battle.restart_what_ended() == ["monitoring/prometheus"]
    until(partial(battle.pods["monitoring"].passes, "prometheus", "livenessProbe"), 30, "it is back")


def test_after_a_crash_of_ros_it_alone_is_restarted_and_all_begin_anew(battle: ClusterBattle) -> None:
    master = battle.pods["master"]
    master.kill("ros-master")
    assert battle.restart_what_ended() == ["master/ros-master"]
    for name in ("rosbridge", "web", "camera-relay", "rosout"):
        until(lambda name=name: "the program begins anew" in master.logs(name), 60, f"{name} has noticed")
    battle.wait_until_ready(120)

    # a robot that is ready has not registered with the new master yet
    until(lambda: a_bot_waits(battle), 60, "a new battle can begin")
    with Player(battle, "Bea") as bea:
        assert bea.ready() == "OK"
        bea.wait_for_game(PLAYING, 60)
    assert battle.restart_what_ended() == []


def test_a_pod_that_is_older_than_the_services_ends_its_programs_until_they_are_there(battle: ClusterBattle) -> None:
    """A kubelet starts an ended container with the addresses that it knows then."""
    for pod_name, says in {
        "robot-0": {"arduino": "ARENA_SERVICE_PORT_LINK", "robot": "LASERBOT_WEB_PORT=$(MASTER_SERVICE_PORT_WEB)"},
        "bot": {"bot": "LASERBOT_WEB_PORT=$(MASTER_SERVICE_PORT_WEB)"},
    }.items():
        pod = battle.pods[pod_name]
        pod.start(battle.manifests, {})
        for name, words in says.items():
            until(partial(pod.has_ended, name), 20, f"{name} ends")
            assert pod.state(name)["ExitCode"] == 2
            assert words in pod.logs(name)
    assert len(battle.restart_what_ended()) == 3
    battle.wait_until_ready(120)


def test_the_master_is_found_by_its_services_while_a_part_of_it_is_not_ready(battle: ClusterBattle) -> None:
    master = battle.pods["master"]
    master.kill("rosbridge")
    assert requests.post(f"{battle.web}/updateGameStatus", timeout=LATEST).ok
    assert battle.restart_what_ended() == ["master/rosbridge"]
    battle.wait_until_ready()


@pytest.fixture
def robot_with_a_device(version: str, tmp_path: Path) -> Iterator[Pod]:
    """The robot of the lan overlay, on a host whose /dev/laserbot belongs to the group dialout."""
    (tmp_path / "dev").mkdir()
    # any device that no container may open by default
    os.mknod(tmp_path / "dev/laserbot", stat.S_IFCHR | 0o660, os.makedev(10, 229))
    os.chown(tmp_path / "dev/laserbot", 0, 20)
    (tmp_path / "dev/laserbot").chmod(0o660)
    pod = Pod(overlay("lan").one("DaemonSet", "robot"), "raspberrypi1", tmp_path)
    pod.start(overlay("lan").within("laserbot"), {"master": pod.address})
    yield pod
    pod.remove()


needs_root = pytest.mark.skipif(os.getuid() != 0, reason="only root can make a device")
SET_ID = """
import os, stat
for folder, _, files in os.walk("/usr"):
    for path in (os.path.join(folder, name) for name in files):
        if os.lstat(path).st_mode & (stat.S_ISUID | stat.S_ISGID) and stat.S_ISREG(os.lstat(path).st_mode):
            print(path)
"""
OPEN = "import os; os.close(os.open('/host/dev/laserbot', os.O_RDWR)); print('open')"


@needs_root
def test_a_real_robot_opens_its_device_without_being_root(robot_with_a_device: Pod) -> None:
    pod = robot_with_a_device
    assert pod.exec("robot", "python3", "-c", OPEN).strip() == "open"
    status = pod.exec("robot", "cat", "/proc/1/status")
    assert "CapEff:\t0000000000000000" in status
    assert "Uid:\t10001\t10001\t10001\t10001" in status
    assert pod.exec("robot", "python3", "-c", SET_ID) == ""


@needs_root
def test_without_privilege_the_device_is_refused(robot_with_a_device: Pod) -> None:
    """The reason why overlays/lan/robots.yaml asks for it."""
    pod = robot_with_a_device
    pod.spec = json.loads(json.dumps(pod.spec))
    pod.spec["containers"][0]["securityContext"] = {"readOnlyRootFilesystem": True}
    pod.start_container("robot", overlay("lan").within("laserbot"), {"master": pod.address})
    with pytest.raises(AssertionError, match="Operation not permitted"):
        pod.exec("robot", "python3", "-c", OPEN)


@pytest.fixture
def arduino(tmp_path: Path) -> Iterator[str]:
    """The path of a serial line with the firmware behind it, of the group that a Raspberry Pi's has."""
    line = tmp_path / "ttyACM0"
    words = ["--firmware", f"{ROOT}/build/firmware/laserbot.elf", "--name", "raspberrypi1", "--serial", str(line)]
    program = Program([f"{ROOT}/build/sim/avr_robot", *words])
    program.wait_for("UART at")
    device = os.path.realpath(line)
    os.chown(device, 0, 20)
    Path(device).chmod(0o660)
    yield device
    program.stop()


@needs_root
def test_a_real_robot_gets_the_id_of_its_node(version: str, arduino: str, tmp_path: Path) -> None:
    """The pods of the lan overlay, but that each has a network of its own instead of a host's."""
    manifests = overlay("lan").within("laserbot")
    port = free_port()
    web = f"http://127.0.0.1:{port}"
    master = Pod(manifests.one("Deployment", "master"), "laser-bot-master", tmp_path / "master", {port: 5000})
    # the path must be there to be covered by a device
    (tmp_path / "robot/dev").mkdir(parents=True)
    (tmp_path / "robot/dev/ttyACM0").touch()
    devices = {"/host/dev/ttyACM0": arduino}
    robot = Pod(manifests.one("DaemonSet", "robot"), "raspberrypi2", tmp_path / "robot", devices=devices)
    try:
        for pod in (robot, master):
            pod.start(manifests, {"master": master.address})
        master.wait_until_ready()
        robot.wait_until_ready()

        def robots() -> int:
            return int(requests.post(f"{web}/getAvailableRobots", timeout=LATEST).json()["availableR"])

        until(lambda: robots() == 1, 30, "the robot is offered")
        reply = requests.post(f"{web}/signUpUser", data={"data": "Ann"}, timeout=LATEST)
        assert json.loads(reply.text)["robot"] == 2
    finally:
        robot.remove()
        master.remove()


def test_a_robot_without_arduino_says_so_and_is_not_ready(version: str, tmp_path: Path) -> None:
    pod = Pod(overlay("lan").one("DaemonSet", "robot"), "raspberrypi1", tmp_path)
    try:
        pod.start(overlay("lan").within("laserbot"), {"master": pod.address})
        until(lambda: "No attached ARDUINO found: looked for /host/dev/laserbot" in pod.logs("robot"), 20)
        assert pod.state("robot")["Running"]
        words = "health: no sign of work"  # what the kubelet's event quotes
        with pytest.raises(AssertionError, match=words):
            pod.exec("robot", *pod.of("robot")["readinessProbe"]["exec"]["command"])
        assert words in kubernetes_pages()
    finally:
        pod.remove()
