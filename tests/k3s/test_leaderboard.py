"""components/leaderboard: the arenas' web servers and the one PostgreSQL of all."""

import kubernetes_validate
import pytest
from sqlalchemy import make_url

from tests.k3s.conftest import Customize
from tests.k3s.test_overlays import VERSIONS
from tests.k3s.test_rights import is_restricted, level
from tests.support.manifests import SECRET, Kubelet, Manifests, Object, overlay
from tests.support.program_settings import ProgramSettings


@pytest.fixture
def arenas(customize: Customize) -> Manifests:
    return customize("arenas", "leaderboard")


def secret_of(container: Object) -> Object:
    (secret,) = [
        item["valueFrom"]["secretKeyRef"]
        for item in container["env"]
        if "secretKeyRef" in item.get("valueFrom", {}) and not item["valueFrom"]["secretKeyRef"].get("optional")
    ]
    return dict(secret)


def web_of(manifests: Manifests, namespace: str) -> tuple[Object, Object]:
    pod: Object = manifests.within(namespace).one("Deployment", "master")["spec"]["template"]["spec"]
    (web,) = [container for container in pod["containers"] if container["name"] == "web"]
    return pod, web


def test_every_arena_reaches_the_same_database_by_a_name_of_its_own(arenas: Manifests) -> None:
    service = arenas.one("Service", "leaderboard")["spec"]
    server = arenas.one("StatefulSet", "leaderboard")
    (postgres,) = server["spec"]["template"]["spec"]["containers"]
    assert service["selector"].items() <= server["spec"]["template"]["metadata"]["labels"].items()
    told = {item["name"]: item.get("value") for item in postgres["env"]}
    found = {}
    for namespace in overlay("arenas").namespaces:
        pod, web = web_of(arenas, namespace)
        fields = {"metadata.namespace": namespace, "status.podIP": "10.42.0.7"}
        kubelet = Kubelet(arenas.within(namespace), pod, fields, {})
        settings = ProgramSettings(kubelet.command(web), kubelet.environment(web)).settings
        assert settings is not None
        found[settings.arena] = settings.database
        assert secret_of(web) == secret_of(postgres)
    assert set(found) == set(overlay("arenas").namespaces)
    wanted = make_url(f"postgresql+pg8000://laserbot:{SECRET}@{service['clusterIP']}/laserbot")
    assert set(found.values()) == {wanted}
    assert (told["POSTGRES_USER"], told["POSTGRES_DB"]) == (wanted.username, wanted.database)
    assert [port["port"] for port in service["ports"]] == [5432]


def test_the_database_outlives_its_pod_and_has_no_rights(arenas: Manifests) -> None:
    server = arenas.one("StatefulSet", "leaderboard")
    pod = server["spec"]["template"]["spec"]
    (postgres,) = pod["containers"]
    (claim,) = arenas.within(server["metadata"]["namespace"]).of("PersistentVolumeClaim")
    (volume,) = [
        each["name"]
        for each in pod["volumes"]
        if each.get("persistentVolumeClaim") == {"claimName": claim["metadata"]["name"]}
    ]
    (data,) = [mount["mountPath"] for mount in postgres["volumeMounts"] if mount["name"] == volume]
    folder = {item["name"]: item.get("value") for item in postgres["env"]}["PGDATA"]
    assert folder.startswith(f"{data}/")
    assert is_restricted(pod)
    assert level(arenas) == {"restricted"}
    assert pod["automountServiceAccountToken"] is False


@pytest.mark.parametrize("kubernetes", [VERSIONS[0], VERSIONS[-1]])
def test_it_fits_the_schemas(arenas: Manifests, kubernetes: str) -> None:
    for item in arenas.objects:
        kubernetes_validate.validate(item, kubernetes, strict=True)
        assert item["kind"] == "Namespace" or item["metadata"]["namespace"] in arenas.namespaces


def test_its_image_can_be_one_of_the_operators_registry(customize: Customize) -> None:
    entry = {"name": "postgres", "newName": "192.168.1.20:5000/postgres"}
    changed = customize("arenas", "leaderboard", images=[entry]).one("StatefulSet", "leaderboard")
    assert changed["spec"]["template"]["spec"]["containers"][0]["image"] == "192.168.1.20:5000/postgres:17"
