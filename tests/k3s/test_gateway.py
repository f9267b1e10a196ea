"""components/gateway and components/certificate: the front's paths by the Gateway API, and TLS by cert-manager."""

import re
from typing import Any

import pytest
import yaml

from laser_bot_battle.proxies import is_proxy
from tests.k3s.conftest import Customize
from tests.support.crds import is_custom, problems
from tests.support.documents import kubernetes_pages
from tests.support.manifests import Kubelet, Manifests, Object
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT

README = kubernetes_pages()
FRONT = (ROOT / "server/front/nginx.conf.j2").read_text()
HOST = "arena.example"
EXAMPLE: Object = yaml.safe_load(next(re.finditer(r"^configMapGenerator:\n.*host-name.*\n", README, re.MULTILINE))[0])


@pytest.fixture(params=["sim", "lan"])
def manifests(request: pytest.FixtureRequest, customize: Customize) -> Manifests:
    return customize(request.param, "gateway", "certificate", **EXAMPLE)


def rules(manifests: Manifests) -> dict[str, Object]:
    """By the path that they match, of the address with TLS."""
    return {
        match["path"]["value"]: rule
        for route in manifests.of("HTTPRoute")
        if route["spec"]["parentRefs"] == [{"name": "front", "sectionName": "tls"}]
        for rule in route["spec"]["rules"]
        for match in rule["matches"]
    }


def test_they_fit_the_definitions_of_their_makers(manifests: Manifests) -> None:
    custom = [item for item in manifests.objects if is_custom(item)]
    assert {item["kind"] for item in custom} == {"Gateway", "HTTPRoute", "Certificate"}
    assert problems(*custom) == []
    assert {item["metadata"]["namespace"] for item in custom} == {"laserbot"}


def test_what_is_wrong_would_be_noticed(manifests: Manifests) -> None:
    wrong = manifests.one("HTTPRoute", "front")
    wrong = {**wrong, "spec": {**wrong["spec"], "hostname": HOST}}
    assert problems(wrong) == ["spec.hostname is no field"]
    gateway = manifests.one("Gateway", "front")
    assert problems({**gateway, "spec": {**gateway["spec"], "listeners": [{"name": "tls", "port": 443}]}})


def test_each_path_leads_to_its_program_as_at_the_front(manifests: Manifests) -> None:
    found = {
        path: (rule["backendRefs"][0]["name"], rule["backendRefs"][0]["port"])
        for path, rule in rules(manifests).items()
    }
    assert found == {
        "/": ("master", 5000),
        "/rosbridge": ("master", 9090),
        "/camera": ("master", 9091),
    }
    paths = {path.rstrip("/") for path in re.findall(r"location (?:= )?(/(?:rosbridge|camera)?) {\n", FRONT)}
    assert {path.rstrip("/") for path in found} == paths
    for name, port in found.values():
        for service in manifests.of("Service"):
            if service["metadata"]["name"] == name:
                assert port in {each["port"] for each in service["spec"]["ports"]}


def test_the_programs_are_told_that_there_is_a_front_and_get_their_own_paths(manifests: Manifests) -> None:
    rewritten = {}
    for path, rule in rules(manifests).items():
        header, *others = rule["filters"]
        assert header["requestHeaderModifier"] == {"set": [{"name": "X-Laserbot-Front", "value": "yes"}]}
        rewritten[path] = [each["urlRewrite"]["path"] for each in others]
    whole = [{"type": "ReplaceFullPath", "replaceFullPath": "/"}]
    assert rewritten == {"/": [], "/rosbridge": whole, "/camera": whole}


def test_the_certificate_is_the_gateways_and_port_80_only_shows_the_way(manifests: Manifests) -> None:
    certificate = manifests.one("Certificate", "front")["spec"]
    gateway = manifests.one("Gateway", "front")["spec"]
    plain, tls = gateway["listeners"]
    assert tls["tls"] == {"mode": "Terminate", "certificateRefs": [{"name": certificate["secretName"]}]}
    assert (plain["port"], tls["port"]) == (80, 443)
    names = {HOST, certificate["dnsNames"][0], plain["hostname"], tls["hostname"]}
    names |= {name for route in manifests.of("HTTPRoute") for name in route["spec"]["hostnames"]}
    assert names == {HOST}
    assert (gateway["gatewayClassName"], certificate["issuerRef"]["name"]) == ("traefik", "letsencrypt")
    redirect = manifests.one("HTTPRoute", "plain")["spec"]
    assert redirect["parentRefs"] == [{"name": "front", "sectionName": plain["name"]}]
    (rule,) = redirect["rules"]
    assert rule["filters"][0]["requestRedirect"] == {"scheme": "https", "statusCode": 301}


def test_the_programs_believe_the_proxy_and_know_the_name(manifests: Manifests) -> None:
    pod = manifests.one("Deployment", "master")["spec"]["template"]["spec"]
    kubelet = Kubelet(manifests, pod, {"status.podIP": "10.42.0.7"}, {})
    for container in pod["containers"]:
        settings: Any = ProgramSettings(kubelet.command(container), kubelet.environment(container)).settings
        if container["name"] in {"web", "rosbridge", "camera-relay"}:
            assert is_proxy("10.42.3.4", settings.proxies)
            assert settings.origins == (f"https://{HOST}",)


@pytest.mark.parametrize("component", ["ingress", "front"])
def test_the_certificate_serves_the_other_ways_in_as_well(customize: Customize, component: str) -> None:
    manifests = customize("sim", component, "certificate", **EXAMPLE)
    secret = manifests.one("Certificate", "front")["spec"]["secretName"]
    told = [route["spec"]["tls"]["secretName"] for route in manifests.of("IngressRoute") if "tls" in route["spec"]]
    pod = manifests.one("Deployment", "master")["spec"]["template"]["spec"]
    told += [volume["secret"]["secretName"] for volume in pod["volumes"] if "secret" in volume]
    assert set(told) == {secret}
