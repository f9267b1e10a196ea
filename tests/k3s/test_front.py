"""components/front: the game's own front in the master's pod, behind a load balancer's ports 80 and 443."""

import re
from pathlib import Path

import pytest
import yaml

from server.front.settings import FrontSettings
from tests.k3s.conftest import Customize
from tests.support.documents import kubernetes_pages
from tests.support.manifests import Kubelet, Manifests, Object, overlay
from tests.support.program_settings import ProgramSettings

README = kubernetes_pages()


def pod_of(manifests: Manifests) -> Object:
    return dict(manifests.one("Deployment", "master")["spec"]["template"]["spec"])


def container_of(manifests: Manifests, name: str) -> Object:
    (found,) = [each for each in pod_of(manifests)["containers"] if each["name"] == name]
    return dict(found)


def environment_of(manifests: Manifests, name: str) -> dict[str, str]:
    kubelet = Kubelet(manifests, pod_of(manifests), {"status.podIP": "10.42.0.7"}, {})
    return kubelet.environment(container_of(manifests, name))


def settings_of(manifests: Manifests) -> FrontSettings:
    return FrontSettings.from_env(environment_of(manifests, "front"))


@pytest.fixture(params=["lan+front", "sim+front"])
def manifests(request: pytest.FixtureRequest) -> Manifests:
    return overlay(request.param).within("laserbot")


def test_visitors_of_the_usual_ports_come_to_the_front_and_keep_their_addresses(manifests: Manifests) -> None:
    service = manifests.one("Service", "front")["spec"]
    inside = {port["name"]: port["containerPort"] for port in container_of(manifests, "front")["ports"]}
    told = settings_of(manifests)
    led = {port["port"]: inside[port["targetPort"]] for port in service["ports"]}
    assert led == {80: told.http_port, 443: told.https_port}
    assert min(led.values()) >= 1024, "it is not root"
    assert (service["type"], service["externalTrafficPolicy"]) == ("LoadBalancer", "Local")


def test_the_front_finds_the_programs_of_its_pod(manifests: Manifests) -> None:
    told = settings_of(manifests)
    found = {"web": told.web_port, "rosbridge": told.rosbridge_port, "camera-relay": told.relay_port}
    for name, number in found.items():
        assert [port["containerPort"] for port in container_of(manifests, name)["ports"]] == [number]


def test_the_secret_of_kubectl_is_a_certificate_to_the_front_and_may_be_missing(
    manifests: Manifests, tmp_path: Path
) -> None:
    assert "create secret tls front " in README
    (secret,) = [volume["secret"] for volume in pod_of(manifests)["volumes"] if "secret" in volume]
    (mount,) = [each for each in container_of(manifests, "front")["volumeMounts"] if each["name"] == "tls"]
    environment = environment_of(manifests, "front")
    assert (secret["secretName"], mount["mountPath"]) == ("front", environment["LASERBOT_TLS"])
    assert secret["optional"] is True
    files = {item["key"]: tmp_path / item["path"] for item in secret["items"]}
    assert files.keys() == {"tls.crt", "tls.key", "ca.crt"}
    environment["LASERBOT_TLS"] = str(tmp_path)
    assert FrontSettings.from_env(environment).certificate is None
    for file in files.values():
        file.touch()
    found = FrontSettings.from_env(environment).certificate
    assert found is not None
    assert found.files == tuple(files.values())


def test_a_real_name_is_one_of_the_games_to_all_programs(customize: Customize) -> None:
    (example,) = re.findall(r"^patches:\n.*?(?=```)", README, re.DOTALL | re.MULTILINE)
    (patch,) = yaml.safe_load(example)["patches"]
    patch["patch"] = "\n".join(line for line in patch["patch"].splitlines() if "LASERBOT_ORIGINS" in line)
    manifests = customize("sim", "front", patches=[patch])
    for name in ("web", "rosbridge", "camera-relay"):
        command = container_of(manifests, name)["command"]
        settings = ProgramSettings(command, environment_of(manifests, name)).settings
        assert settings is not None
        assert settings.origins == ("https://arena.example",)


def test_each_arena_can_have_a_front_of_its_own(customize: Customize) -> None:
    manifests = customize("arenas/made/red", "front", namespace="laserbot-red")
    assert {item["metadata"].get("namespace", "laserbot-red") for item in manifests.objects} == {"laserbot-red"}
    assert settings_of(manifests).https_port == 8443
