"""components/ingress: Traefik has the same paths as the front, and the programs believe it."""

import re
from typing import Any

import kubernetes_validate
import pytest
import yaml

from laser_bot_battle.proxies import is_proxy
from tests.k3s.conftest import Customize
from tests.k3s.test_overlays import VERSIONS
from tests.support.documents import kubernetes_pages
from tests.support.manifests import Kubelet, Manifests, Object
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT

README = kubernetes_pages()
FRONT = (ROOT / "server/front/nginx.conf.j2").read_text()
TRAEFIK = {"IngressRoute", "Middleware"}  # its own kinds, for which there are no schemas here


@pytest.fixture(params=["sim", "lan"])
def manifests(request: pytest.FixtureRequest, customize: Customize) -> Manifests:
    return customize(request.param, "ingress")


def rules(manifests: Manifests) -> dict[str, Object]:
    """By what they match; of the address with TLS."""
    return {
        rule["match"]: rule
        for route in manifests.of("IngressRoute")
        if route["spec"]["entryPoints"] == ["websecure"]
        for rule in route["spec"]["routes"]
    }


def test_each_path_leads_to_its_program_as_at_the_front(manifests: Manifests) -> None:
    found = rules(manifests)
    programs = {
        "PathPrefix(`/`)": ("master", "web"),
        "Path(`/rosbridge`)": ("master", "rosbridge"),
        "Path(`/camera`)": ("master", "relay"),
    }
    services = {match: rule["services"][0] for match, rule in found.items()}
    assert {match: (to["name"], to["port"]) for match, to in services.items()} == programs
    paths = {path for match in found for path in re.findall(r"`(/\w*/?)`", match)}
    assert paths == set(re.findall(r"location (?:= )?(/(?:rosbridge|camera)?) {\n", FRONT))
    ports = {item["metadata"]["name"]: item["spec"].get("ports") for item in manifests.of("Service")}
    for name, port in programs.values():
        assert port in {each["name"] for each in ports[name]}


def test_the_programs_are_told_that_there_is_a_front_and_get_their_own_paths(manifests: Manifests) -> None:
    specs = {item["metadata"]["name"]: item["spec"] for item in manifests.of("Middleware")}
    for match, rule in rules(manifests).items():
        given = [specs[each["name"]] for each in rule["middlewares"]]
        assert given[0] == {"headers": {"customRequestHeaders": {"X-Laserbot-Front": "yes"}}}
        cut = [prefix for each in given for prefix in each.get("stripPrefix", {}).get("prefixes", ())]
        assert bool(cut) == (match != "PathPrefix(`/`)")
        assert all(any(path.startswith(prefix) for prefix in cut) for path in re.findall(r"`(/\w+)", match))
    assert "proxy_set_header X-Laserbot-Front yes;" in FRONT


def test_it_has_the_certificate_of_a_secret_and_port_80_only_shows_the_way(manifests: Manifests) -> None:
    for route in manifests.of("IngressRoute"):
        if route["spec"]["entryPoints"] == ["websecure"]:
            assert route["spec"]["tls"] == {"secretName": "front"}
        else:
            (rule,) = route["spec"]["routes"]
            assert rule["middlewares"] == [{"name": "to-tls"}]
    assert "create secret tls front " in README


def test_the_programs_believe_traefik_and_know_the_real_name(customize: Customize) -> None:
    (example,) = re.findall(r"^patches:\n.*?(?=```)", README, re.DOTALL | re.MULTILINE)
    manifests = customize("sim", "ingress", **yaml.safe_load(example))
    pod = manifests.one("Deployment", "master")["spec"]["template"]["spec"]
    kubelet = Kubelet(manifests, pod, {"status.podIP": "10.42.0.7"}, {})
    for container in pod["containers"]:
        settings: Any = ProgramSettings(kubelet.command(container), kubelet.environment(container)).settings
        if container["name"] not in {"ros-master", "rosout"}:
            assert is_proxy("10.42.3.4", settings.proxies)
            assert settings.origins == ("https://arena.example",)


def test_all_but_traefiks_own_fits_the_schemas(manifests: Manifests) -> None:
    for item in manifests.objects:
        assert item["kind"] == "Namespace" or item["metadata"]["namespace"] == "laserbot"
        if item["kind"] in TRAEFIK:
            assert item["apiVersion"] == "traefik.io/v1alpha1"
        else:
            kubernetes_validate.validate(item, VERSIONS[0], strict=True)
