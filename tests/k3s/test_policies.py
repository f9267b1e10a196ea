"""components/network-policies: who may talk to whom, tried with pods that are network namespaces."""

import re
import subprocess
import sys
from collections.abc import Iterator
from typing import NamedTuple

import kubernetes_validate
import pytest
import yaml

from tests.k3s.conftest import Customize
from tests.k3s.test_overlays import VERSIONS
from tests.support.documents import kubernetes_pages
from tests.support.lan import NETWORK, Lan, Machine, needs_root
from tests.support.manifests import Manifests, Object, overlay
from tests.support.policies import Pod, pod_of, ruleset
from tests.support.programs import ROOT, Program

README = kubernetes_pages()
PEOPLE = {"web", "rosbridge", "relay", "view"}
PORTS = (5000, 8080, 8081, 9090, 9091, 11311, 40000, 5432, 9200)  # 40000: one that a ROS node might choose
LISTEN = f"""
import socket
kept = [socket.create_server(("0.0.0.0", port), backlog=100) for port in {PORTS}]
print("listening", flush=True)
while True:
    socket.socket.accept(kept[0])
"""
KNOCK = """
import socket, sys
for place in sys.argv[1:]:
    host, port = place.split(":")
    try:
        socket.create_connection((host, int(port)), 5).close()
        print(place)
    except OSError:
        pass
"""
# a node of ROS, whose master is the first argument
ROBOT = """
import sys, rospy
from laser_bot_battle.msg import Robot_msg
rospy.init_node("Robot1", disable_signals=True)
rospy.Subscriber("/Robot1/command", Robot_msg, lambda command: print("driven:", command.linear_x, flush=True))
print("waits", flush=True)
rospy.spin()
"""
DRIVE = """
import sys, rospy
from laser_bot_battle.msg import Robot_msg
rospy.init_node("driver", anonymous=True, disable_signals=True)
publisher = rospy.Publisher("/Robot1/command", Robot_msg, queue_size=1)
while True:
    publisher.publish(Robot_msg(int(sys.argv[1]), 0, False))
    rospy.rostime.wallsleep(0.1)
"""


class Cluster(NamedTuple):
    """Pods of two arenas, a pod of somebody else's, the leaderboard's, and a visitor in the LAN."""

    machines: dict[str, Machine]
    pods: dict[str, Pod]  # of all but the visitor
    policies: Manifests

    def enforce(self) -> None:
        for name, pod in self.pods.items():
            rules = ruleset(pod, list(self.pods.values()), self.policies)
            command = self.machines[name].command("nft", "-f", "-")
            subprocess.run(command, input=rules, text=True, check=True)

    def open(self) -> None:
        for name in self.pods:
            self.machines[name].run("nft", "flush", "ruleset")

    def reached(self, who: str, whom: str) -> set[int]:
        places = [f"{self.address(whom)}:{port}" for port in PORTS]
        found = self.machines[who].run(sys.executable, "-c", KNOCK, *places)
        return {int(place.rpartition(":")[2]) for place in found.split()}

    def address(self, name: str) -> str:
        return f"{NETWORK}.{list(self.machines).index(name) + 1}"


def workload(manifests: Manifests, namespace: str, name: str) -> Object:
    (found,) = [each for each in manifests.within(namespace).workloads if each["metadata"]["name"] == name]
    return found


@pytest.fixture(scope="module")
def cluster() -> Iterator[Cluster]:
    manifests = overlay("arenas")
    names = [f"{arena} {pod}" for arena in ("red", "blue") for pod in ("master", "robot", "arena", "bot")]
    with Lan() as lan:
        machines = {name: lan.machine() for name in (*names, "stranger", "leaderboard", "visitor")}
        found = Cluster(machines, {}, manifests)
        for name in names:
            arena, pod = name.split()
            found.pods[name] = pod_of(workload(manifests, f"laserbot-{arena}", pod), found.address(name))
        # the labels of a pod are its owner's choice
        labels = found.pods["red master"].labels
        found.pods["stranger"] = Pod("default", found.address("stranger"), labels)
        found.pods["leaderboard"] = Pod("laserbot-leaderboard", found.address("leaderboard"))
        yield found


@pytest.fixture
def listening(cluster: Cluster) -> Iterator[Cluster]:
    """All listen at all ports, and the policies hold."""
    programs = [machine.program(sys.executable, "-c", LISTEN) for machine in cluster.machines.values()]
    try:
        for program in programs:
            program.wait_for("listening")
        cluster.enforce()
        yield cluster
    finally:
        cluster.open()
        for program in programs:
            program.kill()


@needs_root
def test_each_reaches_what_it_needs_and_nothing_else(listening: Cluster) -> None:
    every, people = set(PORTS), {5000, 9090, 9091}
    expected = {
        ("red robot", "red master"): every,  # ROS nodes choose their ports
        ("red master", "red robot"): every,
        ("red robot", "red arena"): every,
        ("red bot", "red master"): every,
        ("blue master", "red master"): set(),  # nothing goes out of an arena
        ("blue robot", "red robot"): set(),
        ("stranger", "red master"): people,
        ("stranger", "red arena"): {8080},
        ("stranger", "red robot"): set(),
        ("visitor", "red master"): people,
        ("visitor", "red arena"): {8080},
        ("visitor", "red robot"): set(),
        ("visitor", "red bot"): set(),
        ("red master", "leaderboard"): {5432},
        ("red robot", "leaderboard"): set(),
        ("red master", "visitor"): set(),
        ("red robot", "stranger"): set(),
    }
    assert {pair: listening.reached(*pair) for pair in expected} == expected


@needs_root
def test_a_pod_of_another_namespace_cannot_drive_a_robot(cluster: Cluster) -> None:
    """But one of the arena's can, and without the policies the other could, too."""

    def ros(name: str) -> dict[str, str]:
        return {
            "ROS_MASTER_URI": f"http://{cluster.address('red master')}:11311",
            "ROS_IP": cluster.address(name),
            "PYTHONPATH": f"{ROOT}:{ROOT / 'build/python'}",
        }

    def driver(name: str, speed: int) -> Program:
        return cluster.machines[name].program(sys.executable, "-c", DRIVE, str(speed), env=ros(name))

    cluster.enforce()
    programs = [cluster.machines["red master"].python("server.ros.master", "-p", "11311", env=ros("red master"))]
    try:
        robot = cluster.machines["red robot"].program(sys.executable, "-c", ROBOT, env=ros("red robot"))
        programs.append(robot)
        robot.wait_for("waits")
        others = [driver(name, speed) for speed, name in enumerate(("stranger", "blue robot", "visitor"), 1)]
        programs += [*others, driver("red bot", 4)]
        robot.wait_for("driven: 4")
        for other in others:
            other.wait_for("Unable to")  # register with the master; it keeps trying
        assert not re.search("driven: [123]", robot.output)
        cluster.open()
        robot.wait_for("driven: 1")
    finally:
        cluster.open()
        for program in programs:
            program.kill()


def test_every_pod_of_an_arena_is_shut_by_default() -> None:
    for namespace in overlay("arenas").namespaces:
        here = overlay("arenas").within(namespace)
        policy = here.one("NetworkPolicy", "arena")["spec"]
        for each in here.workloads:
            assert (
                policy["podSelector"]["matchLabels"].items() <= each["spec"]["template"]["metadata"]["labels"].items()
            )
        assert set(policy["policyTypes"]) == {"Ingress", "Egress"}


def test_what_a_policy_names_is_there() -> None:
    manifests = overlay("sim+front+monitoring+overhead").within("laserbot")
    pods = [pod_of(each, "10.0.0.1") for each in manifests.workloads]
    for policy in manifests.of("NetworkPolicy"):
        labels = policy["spec"]["podSelector"]["matchLabels"].items()
        selected = [pod for pod in pods if labels <= pod.labels.items()]
        assert selected, policy["metadata"]["name"]
        for rule in policy["spec"].get("ingress", ()):
            for port in rule.get("ports", ()):
                assert all(port["port"] in pod.ports for pod in selected)


def example_for(policy: str) -> list[Object]:
    """The patch of the policy in the documents."""
    (example,) = re.findall(rf"^- target: {{kind: NetworkPolicy, name: {policy}}}.*?(?=```)", README, re.DOTALL | re.M)
    return list(yaml.safe_load(example))


@needs_root
def test_a_master_with_a_tracker_reaches_its_camera_and_no_other_does(customize: Customize) -> None:
    narrowed = example_for("overhead")
    (operation,) = yaml.safe_load(narrowed[0]["patch"])
    (rule,) = operation["value"]
    rule["to"][0]["ipBlock"]["cidr"] = f"{NETWORK}.2/32"
    rule["ports"][0]["port"] = PORTS[1]
    narrowed[0]["patch"] = yaml.safe_dump([operation])
    reached = []
    with Lan() as lan:
        machines = {"master": lan.machine(), "camera": lan.machine()}
        camera = machines["camera"].program(sys.executable, "-c", LISTEN)
        try:
            camera.wait_for("listening")
            for manifests in (
                overlay("sim"),
                overlay("sim+overhead"),
                customize("sim", "overhead", patches=narrowed),
            ):
                here = Cluster(machines, {}, manifests)
                here.pods["master"] = pod_of(manifests.one("Deployment", "master"), here.address("master"))
                here.enforce()
                reached.append(here.reached("master", "camera"))
        finally:
            camera.kill()
    assert reached == [set(), set(PORTS), {PORTS[1]}]


def test_a_database_elsewhere_is_reached_by_the_readmes_patch(customize: Customize) -> None:
    manifests = customize("sim", patches=example_for("database"))
    policy = manifests.one("NetworkPolicy", "database")
    kubernetes_validate.validate(policy, VERSIONS[0], strict=True)
    master = pod_of(manifests.one("Deployment", "master"), "10.42.0.7")
    assert "ip daddr 192.168.1.30/32 tcp dport 5432 accept" in ruleset(master, [master], manifests)


def test_what_the_services_open_to_people_is_what_the_policies_open() -> None:
    manifests = overlay("sim").within("laserbot")
    opened = {
        port["targetPort"]
        for service in manifests.of("Service")
        if service["spec"].get("type") == "NodePort"
        for port in service["spec"]["ports"]
    }
    assert opened == PEOPLE
    for name in ("players", "spectators"):
        (rule,) = manifests.one("NetworkPolicy", name)["spec"]["ingress"]
        assert {port["port"] for port in rule["ports"]} & PEOPLE == {
            port["targetPort"] for port in manifests.one("Service", name)["spec"]["ports"]
        }
