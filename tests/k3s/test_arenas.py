"""Many arenas from a file of a few lines each (k3s/arenas.py), and the one entrance to all of them."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
from sqlalchemy import make_url

from laser_bot_battle.proxies import is_proxy
from server.access.sharing import Sharing, sharing
from tests.k3s.conftest import Customize
from tests.k3s.test_overlays import VERSIONS
from tests.k3s.test_rights import is_restricted
from tests.support.documents import blocks, kubernetes_pages
from tests.support.imagefile import dockerfile
from tests.support.manifests import SECRET, Kubelet, Manifests, Object, overlay
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT

README = kubernetes_pages()
OURS = ROOT / "k3s/overlays/arenas"
BLUE = "namespace: laserbot-blue\nport: 31010\n"
OTHERS = {"IngressRoute", "Middleware", "PodMonitor", "PrometheusRule"}  # for which there are no schemas here


def make(folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "k3s/arenas.py"), str(folder)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def made(folder: Path, **files: str) -> Manifests:
    """What the cluster gets of arenas with these files, by name, and their entrance."""
    for name, text in files.items():
        (folder / f"{name}.yaml").write_text(text)
    result = make(folder)
    assert result.returncode == 0, result.stderr
    components = ["entrance", *(["entrance-host"] if "port:" not in "".join(files.values()) else [])]
    up = os.path.relpath(ROOT / "k3s/components", folder)
    (folder / "kustomization.yaml").write_text(
        "resources: [made]\n" + f"components: [{', '.join(f'{up}/{name}' for name in components)}]\n"
    )
    return Manifests(folder)


def settings_of(manifests: Manifests, namespace: str, workload: str, container: str) -> Any:
    """Of a program, as the kubelet starts it."""
    part = manifests.within(namespace)
    pod = part.one("Deployment", workload)["spec"]["template"]["spec"]
    (found,) = [each for each in pod["containers"] if each["name"] == container]
    kubelet = Kubelet(part, pod, {"metadata.namespace": namespace, "status.podIP": "10.42.0.7"}, {})
    return ProgramSettings(kubelet.command(found), kubelet.environment(found)).settings


def validate(manifests: Manifests) -> None:
    for item in manifests.objects:
        assert item["kind"] == "Namespace" or item["metadata"]["namespace"] in manifests.namespaces
        if item["kind"] not in OTHERS:
            kubernetes_validate.validate(item, VERSIONS[-1], strict=True)


def test_fifty_arenas_of_five_lines_are_valid_and_the_entrance_leads_to_each(tmp_path: Path) -> None:
    arenas = {f"hall{number}": 31000 + 4 * number for number in range(50)}
    files = {
        name: f"namespace: laserbot-{name}\nport: {port}\nrobots: 3\nbots: 0\nrules: {{LASERBOT_HIT_DAMAGE: 20}}\n"
        for name, port in arenas.items()
    }
    assert all(len(text.splitlines()) == 5 for text in files.values())
    manifests = made(tmp_path, **files)
    validate(manifests)
    assert set(manifests.namespaces) == {f"laserbot-{name}" for name in arenas} | {"laserbot-entrance"}
    node_ports = [
        port["nodePort"]
        for item in manifests.of("Service")
        for port in item["spec"].get("ports", ())
        if "nodePort" in port
    ]
    assert len(node_ports) == len(set(node_ports)) == 4 * len(arenas) + 1
    settings = settings_of(manifests, "laserbot-entrance", "entrance", "entrance")
    assert {arena.name: arena.public for arena in settings.arenas} == {name: f":{arenas[name]}" for name in arenas}
    last = manifests.within("laserbot-hall49")
    assert last.one("StatefulSet", "robot")["spec"]["replicas"] == 3
    assert last.one("Deployment", "bot")["spec"]["replicas"] == 0
    assert settings_of(manifests, "laserbot-hall49", "master", "web").rules.bots == {}
    assert settings_of(manifests, "laserbot-hall49", "master", "web").rules.hit_damage == 20


WATCHING = ("metrics", "monitoring", "prometheus-operator")


@pytest.mark.parametrize(("way", "watching"), [("port: 31000", WATCHING[1]), ("host: a.b.example", WATCHING[2])])
def test_an_arena_has_the_components_that_its_file_names(tmp_path: Path, way: str, watching: str) -> None:
    text = f"namespace: laserbot-red\n{way}\n"
    manifests = made(tmp_path, red=f"{text}components: [kept-data, backups, {watching}]\n", blue=BLUE)
    validate(manifests)
    red, blue = (manifests.within(f"laserbot-{name}") for name in ("red", "blue"))
    for part, found in ((red, {"data", "backups"}), (blue, set())):
        assert {item["metadata"]["name"] for item in part.of("PersistentVolumeClaim")} == found
    (data,) = [
        volume
        for volume in red.one("Deployment", "master")["spec"]["template"]["spec"]["volumes"]
        if volume["name"] == "data"
    ]
    assert data["persistentVolumeClaim"] == {"claimName": "data"}
    assert {item["metadata"]["name"] for item in red.of("CronJob")} == {"backup", "restore"}
    kinds = {"monitoring": "Deployment", "prometheus-operator": "PodMonitor"}
    assert red.of(kinds[watching])
    assert not blue.of("PodMonitor", "CronJob")


# in one process, since each would read all settings anew
EACH_COMPONENT = """
import pathlib, sys
k3s, file = map(pathlib.Path, sys.argv[1:])
sys.path.insert(0, str(k3s))
import arenas
for component in sorted(folder.name for folder in (k3s / "components").iterdir()):
    needed = "kept-data, " if component == "backups" else ""
    file.write_text(f"namespace: laserbot-red\\nport: 31000\\ncomponents: [{needed}{component}]\\n")
    print(component, "taken" if arenas.main([str(file.parent)]) == 0 else "", file=sys.stderr)
"""


def test_the_example_of_the_documents_is_an_arena(tmp_path: Path) -> None:
    (example,) = [text for text in blocks(README, "yaml") if text.startswith("namespace: laserbot-red\n")]
    manifests = made(tmp_path, red=example)
    assert manifests.one("StatefulSet", "robot")["spec"]["replicas"] == 4
    assert settings_of(manifests, "laserbot-red", "master", "web").rules.hit_damage == 20


def test_every_component_is_taken_or_said_to_belong_elsewhere(tmp_path: Path) -> None:
    words = [sys.executable, "-c", EACH_COMPONENT, str(ROOT / "k3s"), str(tmp_path / "red.yaml")]
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stderr.splitlines()
    assert {line.split()[0] for line in lines if line.endswith(" taken")} == {"kept-data", "backups", *WATCHING}
    told = [line for line in lines if "red.yaml" in line]
    assert all("red.yaml: the component " in line for line in told)
    assert len(told) == len([*(ROOT / "k3s/components").iterdir()]) - 5


@pytest.mark.parametrize("way", ["port: 31000", "host: red.arena.example"])
def test_the_entrance_asks_a_service_that_is_there_and_shares_sessions_with_it(tmp_path: Path, way: str) -> None:
    manifests = made(tmp_path, red=f"namespace: laserbot-red\n{way}\n")
    validate(manifests)
    entrance = settings_of(manifests, "laserbot-entrance", "entrance", "entrance")
    web = settings_of(manifests, "laserbot-red", "master", "web")
    (arena,) = entrance.arenas
    service, namespace, port = re.fullmatch(r"http://([\w-]+)\.([\w-]+):(\d+)", arena.inside).groups()  # type: ignore[union-attr]
    ports = manifests.within(namespace).one("Service", service)["spec"]["ports"]
    assert ("web", int(port)) in {(each["name"], each["port"]) for each in ports}
    assert entrance.domain == web.domain
    if way.startswith("port"):
        assert (
            sharing(web.domain, "10.0.0.7:31000") == sharing(entrance.domain, "10.0.0.7:30505") == Sharing(True, None)
        )
    else:
        assert (arena.public, web.domain) == ("https://red.arena.example", "arena.example")
        assert web.origins == ("https://red.arena.example",)


def test_by_host_names_no_node_has_ports_and_each_route_is_of_one_host(tmp_path: Path) -> None:
    names = ("red", "blue")
    manifests = made(tmp_path, **{name: f"namespace: laserbot-{name}\nhost: {name}.arena.example\n" for name in names})
    types = [(item["metadata"]["namespace"], item["spec"].get("type")) for item in manifests.of("Service")]
    assert [of for of, kind in types if kind == "NodePort"] == ["laserbot-entrance"]
    hosts = {name: f"{name}.arena.example" for name in names} | {"entrance": "arena.example"}
    for name, host in hosts.items():
        routes = manifests.within(f"laserbot-{name}").of("IngressRoute")
        assert routes
        for rule in (rule for route in routes for rule in route["spec"]["routes"]):
            assert rule["match"].startswith(f"Host(`{host}`)")


def test_visitors_of_the_entrance_keep_their_addresses(tmp_path: Path) -> None:
    """At its port, which only its own node answers, and behind Traefik, whose word it takes."""
    by_port = overlay("arenas+entrance").within("laserbot-entrance")
    service = by_port.one("Service", "entrance")["spec"]
    assert (service["type"], service["externalTrafficPolicy"]) == ("NodePort", "Local")
    affinity = by_port.one("Deployment", "entrance")["spec"]["template"]["spec"]["affinity"]["nodeAffinity"]
    (label,) = affinity["preferredDuringSchedulingIgnoredDuringExecution"]
    (wanted,) = label["preference"]["matchExpressions"]
    assert f"kubectl label node NAME {wanted['key']}={wanted['values'][0]}" in README
    by_host = made(tmp_path, red="namespace: laserbot-red\nhost: red.arena.example\n")
    assert is_proxy("10.42.3.4", settings_of(by_host, "laserbot-entrance", "entrance", "entrance").proxies)


@pytest.mark.parametrize("ways", [("port: 31000", "port: 31010"), ("host: red.arena.example", "port: 31010")])
def test_an_entrance_at_a_host_name_needs_a_domain_that_the_arenas_share(tmp_path: Path, ways: list[str]) -> None:
    for name, way in zip(("red", "blue"), ways, strict=True):
        (tmp_path / f"{name}.yaml").write_text(f"namespace: laserbot-{name}\n{way}\n")
    assert make(tmp_path).returncode == 0
    up = os.path.relpath(ROOT / "k3s/components", tmp_path)
    (tmp_path / "kustomization.yaml").write_text(
        f"resources: [made]\ncomponents: [{up}/entrance, {up}/entrance-host]\n"
    )
    command = [str(ROOT / "ci/kubectl"), "kustomize", str(tmp_path)]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    assert told.returncode == 1
    (line,) = told.stderr.splitlines()
    assert "`data.host` is missing" in line


def test_the_entrance_has_no_more_rights_than_it_needs_and_fits_its_image(tmp_path: Path) -> None:
    manifests = made(tmp_path, red="namespace: laserbot-red\nport: 31000\n").within("laserbot-entrance")
    pod = manifests.one("Deployment", "entrance")["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    image = dockerfile("webserver")
    assert is_restricted(pod)
    assert f"{pod['securityContext']['runAsUser']}:{pod['securityContext']['runAsGroup']}" == image.user
    assert container["livenessProbe"]["exec"]["command"] == image.health
    found = program_of(manifests, pod, container)
    assert {port["containerPort"] for port in container["ports"]} == found.ports
    assert {item["name"] for item in container.get("env", [])} <= found.variables
    assert set(manifests.config("entrance")["data"]) <= found.variables


def program_of(manifests: Manifests, pod: Object, container: Object) -> ProgramSettings:
    kubelet = Kubelet(manifests, pod, {}, {})
    return ProgramSettings(kubelet.command(container), kubelet.environment(container))


def test_with_the_leaderboard_the_entrance_has_the_results_of_all(customize: Customize) -> None:
    manifests = customize("arenas", "entrance", "leaderboard")
    validate(manifests)
    address = manifests.one("Service", "leaderboard")["spec"]["clusterIP"]
    settings = settings_of(manifests, "laserbot-entrance", "entrance", "entrance")
    assert settings.database == make_url(f"postgresql+pg8000://laserbot:{SECRET}@{address}/laserbot")


def test_what_is_made_of_our_own_arenas_is_what_their_files_say(tmp_path: Path) -> None:
    copy = tmp_path / "k3s"
    shutil.copytree(ROOT / "k3s", copy)
    for part in ("server", "laser_bot_battle"):
        (tmp_path / part).symlink_to(ROOT / part)
    folder = copy / "overlays/arenas"
    result = subprocess.run([sys.executable, copy / "arenas.py", folder], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert texts(folder) == texts(OURS), "run k3s/arenas.py k3s/overlays/arenas"


def texts(folder: Path) -> dict[str, str]:
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*") if path.is_file()}


def test_an_arena_that_is_gone_leaves_nothing_behind(tmp_path: Path) -> None:
    made(tmp_path, red="namespace: a\nport: 31000\n", blue="namespace: b\nport: 31010\n")
    (tmp_path / "red.yaml").unlink()
    assert make(tmp_path).returncode == 0
    assert [path.name for path in (tmp_path / "made").iterdir() if path.is_dir()] == ["blue"]


GOOD = "namespace: laserbot-red\nport: 31000\n"


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({}, "has no file of an arena"),
        ({"Red": GOOD}, "Red.yaml: an arena's name"),
        ({"red": "a: b: c"}, "red.yaml: mapping values are not allowed here"),
        ({"red": "- 1"}, "red.yaml: it must have lines such as"),
        ({"red": GOOD + "rule: {}"}, "red.yaml: there is no rule; the nearest is rules"),
        ({"red": "port: 31000"}, "red.yaml: namespace must be"),
        ({"red": "namespace: A_b\nport: 31000"}, "red.yaml: namespace must be"),
        ({"red": "namespace: kube-system\nport: 31000"}, "red.yaml: namespace kube-system is not an arena's"),
        ({"red": "namespace: laserbot-entrance\nport: 31000"}, "namespace laserbot-entrance is not an arena's"),
        ({"red": "namespace: a"}, "red.yaml: it must have either a port or a host"),
        ({"red": GOOD + "host: a.b"}, "red.yaml: it must have either a port or a host"),
        ({"red": "namespace: a\nport: 5000"}, "red.yaml: port must be from 30000 to 32764"),
        ({"red": "namespace: a\nport: true"}, "red.yaml: port must be from"),
        ({"red": "namespace: a\nport: 30504"}, "red.yaml: port 30505 is the entrance's"),
        ({"red": "namespace: a\nhost: http://x"}, "red.yaml: host must be a name"),
        ({"red": GOOD + "robots: 0"}, "red.yaml: robots must be a whole number from 1 to 128"),
        ({"red": GOOD + "components: kept-data"}, "red.yaml: components must be like"),
        (
            {"red": GOOD + "components: [kept-dta]"},
            "red.yaml: there is no component kept-dta; the nearest is kept-data",
        ),
        ({"red": GOOD + "components: [1]"}, "red.yaml: there is no component 1"),
        ({"red": GOOD + "components: [metrics, metrics]"}, "red.yaml: a component is named twice"),
        ({"red": GOOD + "components: [metrics, monitoring]"}, "red.yaml: only one of the components metrics, "),
        ({"red": GOOD + "components: [backups]"}, "red.yaml: the component backups needs kept-data"),
        ({"red": GOOD + "components: [entrance]"}, "red.yaml: the component entrance serves all arenas"),
        ({"red": GOOD + "rules: [1]"}, "red.yaml: rules must be like"),
        (
            {"red": GOOD + "rules: {LASERBOT_HIT_DAMGE: 2}"},
            "red.yaml: there is no rule LASERBOT_HIT_DAMGE; the nearest",
        ),
        ({"red": GOOD + "rules: {LASERBOT_HIT_DAMAGE: lots}"}, "LASERBOT_HIT_DAMAGE=lots: must be a whole number"),
        ({"red": GOOD, "blue": "namespace: b\nport: 31003"}, "red.yaml and blue.yaml have the same port: 31003"),
        ({"red": GOOD, "blue": "namespace: laserbot-red\nport: 31010"}, "have the same namespace: laserbot-red"),
    ],
)
def test_a_wrong_file_is_told_in_one_line_and_changes_nothing(tmp_path: Path, files: dict[str, str], said: str) -> None:
    for name, text in files.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    result = make(tmp_path)
    assert result.returncode == 1
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not (tmp_path / "made").exists()


def test_a_file_with_another_ending_is_not_left_out_in_silence(tmp_path: Path) -> None:
    (tmp_path / "red.yaml").write_text(GOOD)
    (tmp_path / "blue.yml").write_text(BLUE)
    assert "blue.yml: its name must be blue.yaml" in make(tmp_path).stderr
    assert not (tmp_path / "made").exists()


def test_a_folder_of_somebody_elses_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "red.yaml").write_text(GOOD)
    (tmp_path / "made").mkdir()
    (tmp_path / "made/thesis.txt").touch()
    assert "left alone" in make(tmp_path).stderr
    assert (tmp_path / "made/thesis.txt").exists()
