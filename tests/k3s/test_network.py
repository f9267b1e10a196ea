"""Who reaches whom: Services, their ports and selectors, and the addresses in the environment."""

import http.client
import re
from functools import partial

import pytest

from tests.support.documents import kubernetes_pages
from tests.support.manifests import OVERLAYS, Manifests, Object, overlay, service_variables
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.program_settings import ROS, ProgramSettings
from tests.support.programs import ROOT, Program

README = kubernetes_pages()
NAMESPACES = [
    pytest.param(overlay(name).within(namespace), id=f"{name}-{namespace}")
    for name in (*OVERLAYS, "lan+front", "sim+front")
    for namespace in overlay(name).namespaces
]
every_namespace = pytest.mark.parametrize("here", NAMESPACES)


def selected(here: Manifests, selector: Object) -> list[Object]:
    """The workloads whose pods have these labels."""
    return [
        workload
        for workload in here.workloads
        if selector.items() <= workload["spec"]["template"]["metadata"]["labels"].items()
    ]


@every_namespace
def test_each_service_reaches_ports_of_one_kind_of_pod(here: Manifests) -> None:
    for service in here.of("Service"):
        (workload,) = selected(here, service["spec"]["selector"])
        containers = workload["spec"]["template"]["spec"]["containers"]
        open_ports = {port["name"]: port["containerPort"] for each in containers for port in each.get("ports", [])}
        for port in service["spec"].get("ports", []):
            assert port["targetPort"] in open_ports
            if service["spec"].get("type") != "LoadBalancer":
                assert port["port"] == open_ports[port["targetPort"]]


@every_namespace
def test_selectors_match_the_workloads_own_pods_only(here: Manifests) -> None:
    for workload in here.workloads:
        assert selected(here, workload["spec"]["selector"]["matchLabels"]) == [workload]


@every_namespace
def test_a_service_goes_on_while_a_container_of_its_pod_restarts(here: Manifests) -> None:
    for service in here.of("Service"):
        if service["spec"].get("clusterIP") != "None":
            assert service["spec"]["publishNotReadyAddresses"]


@every_namespace
def test_no_variable_that_the_kubelet_adds_means_something_to_a_program(here: Manifests) -> None:
    services = here.of("Service")
    added = service_variables(services, {item["metadata"]["name"]: "10.43.0.1" for item in services})
    assert added
    assert not [name for name in added if name.startswith(("LASERBOT_", "ROS_", "PYTHON"))]


def test_a_service_that_is_named_badly_would_be_noticed() -> None:
    service = {"metadata": {"name": "laserbot-web"}, "spec": {"ports": [{"name": "web", "port": 5000}]}}
    assert "LASERBOT_WEB_PORT" in service_variables([service], {"laserbot-web": "10.43.0.1"})


@every_namespace
def test_nothing_needs_the_clusters_dns(here: Manifests) -> None:
    for workload in here.workloads:
        assert workload["spec"]["template"]["spec"]["dnsPolicy"] == "Default"
    names = "|".join(service["metadata"]["name"] for service in here.of("Service"))
    for _, container in here.containers:
        for item in container.get("env", []):
            assert not re.search(rf"//({names})[:./]|\.svc\b|\.local\b", item.get("value", ""))


def test_the_page_is_told_the_ports_of_the_nodes() -> None:
    for name in ("sim", "arenas"):
        for namespace in overlay(name).namespaces:
            here = overlay(name).within(namespace)
            node_ports = {
                port["targetPort"]: port["nodePort"]
                for service in here.of("Service")
                for port in service["spec"].get("ports", [])
                if "nodePort" in port
            }
            assert set(node_ports) == {"web", "rosbridge", "relay", "view"}
            settings = here.config("settings")
            (web,) = [container for _, container in here.containers if container["name"] == "web"]
            told = ProgramSettings(web["command"], settings.get("data", {})).settings
            assert told is not None
            assert (told.rosbridge_port, told.relay_port) == (node_ports["rosbridge"], node_ports["relay"])


def test_visitors_keep_their_addresses_at_the_node_that_people_name() -> None:
    for name in ("sim", "arenas"):
        for namespace in overlay(name).namespaces:
            here = overlay(name).within(namespace)
            open_to_people = [each for each in here.of("Service") if each["spec"].get("type") == "NodePort"]
            assert {each["metadata"]["name"] for each in open_to_people} == {"players", "spectators"}
            assert all(each["spec"]["externalTrafficPolicy"] == "Local" for each in open_to_people)
            # the arena's own page is at the same host, so both pods are drawn to one node, and to the labelled one
            for pod, other in (("master", "arena"), ("arena", "master")):
                affinity = here.one("Deployment", pod)["spec"]["template"]["spec"]["affinity"]
                (near,) = affinity["podAffinity"]["preferredDuringSchedulingIgnoredDuringExecution"]
                assert selected(here, near["podAffinityTerm"]["labelSelector"]["matchLabels"]) == [
                    here.one("Deployment", other)
                ]
                (label,) = affinity["nodeAffinity"]["preferredDuringSchedulingIgnoredDuringExecution"]
                (wanted,) = label["preference"]["matchExpressions"]
                assert f"kubectl label node NAME {wanted['key']}={wanted['values'][0]}" in README


def test_the_relay_is_told_where_browsers_find_the_pages() -> None:
    for name in ("sim", "arenas"):
        for namespace in overlay(name).namespaces:
            here = overlay(name).within(namespace)
            ports = here.one("Service", "players")["spec"]["ports"]
            (page,) = [str(port["nodePort"]) for port in ports if port["name"] == "web"]
            (relay,) = [container for _, container in here.containers if container["name"] == "camera-relay"]
            assert {"name": "LASERBOT_WEB_PORT", "value": page} in relay["env"]


def test_every_port_of_the_nodes_is_used_once() -> None:
    used = [
        port["nodePort"]
        for name in ("sim", "arenas")
        for service in overlay(name).of("Service")
        for port in service["spec"].get("ports", [])
        if "nodePort" in port
    ]
    assert len(used) == len(set(used)) == 12
    assert all(30000 <= number <= 32767 for number in used)


def test_on_a_lan_pages_and_nodes_have_the_hosts_addresses() -> None:
    here = overlay("lan")
    for workload in here.workloads:
        assert workload["spec"]["template"]["spec"]["hostNetwork"]
    settings = here.config("settings")
    (web,) = [container for _, container in here.containers if container["name"] == "web"]
    (rosbridge,) = [container for _, container in here.containers if container["name"] == "rosbridge"]
    told = ProgramSettings(web["command"], settings.get("data", {})).settings
    assert told is not None
    assert told.rosbridge_port == rosbridge["ports"][0]["containerPort"]


@every_namespace
def test_every_ros_program_says_at_which_address_it_is(here: Manifests) -> None:
    for _, container in here.containers:
        given = {item["name"]: item for item in container.get("env", [])}
        if ROS & set(given):
            assert given["ROS_IP"]["valueFrom"]["fieldRef"]["fieldPath"] in {"status.podIP", "status.hostIP"}
            assert "ROS_MASTER_URI" in given


def test_the_arena_answers_its_probe() -> None:
    (arena,) = [container for _, container in overlay("sim").containers if container["name"] == "arena"]
    view, link = free_port(), free_port()
    environment = {"LASERBOT_ARENA_PORT": str(view), "LASERBOT_ARENA_LINK_PORT": str(link)}
    program = Program.python("sim.arena", env=environment)
    try:
        for probe in ("startupProbe", "readinessProbe", "livenessProbe"):
            place = arena[probe]["httpGet"]
            assert place["port"] == "view"
            until(partial(answers, view, place["path"]), 15, "the arena answers its probe")
    finally:
        program.stop()


def answers(port: int, path: str) -> bool:
    """As a kubelet asks: 200 to 399 is healthy."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=5)
    try:
        connection.request("GET", path)
        return 200 <= connection.getresponse().status < 400
    except OSError:
        return False
    finally:
        connection.close()


def test_every_overlay_and_component_is_explained() -> None:
    text = (ROOT / "k3s/README.md").read_text()
    for folder in (*(ROOT / "k3s/overlays").iterdir(), *(ROOT / "k3s/components").iterdir()):
        assert f"{folder.parent.name}/{folder.name}" in text
