"""What `kubectl apply -k` sends is valid, complete, in an order that works, and of the images of this version."""

import itertools
import os
import re
import shutil
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml
from kubernetes_validate.utils import all_versions

from tests.k3s.conftest import Customize
from tests.support.documents import kubernetes_pages
from tests.support.imagefile import platforms, version
from tests.support.manifests import OVERLAYS, WORKLOADS, Manifests, overlay
from tests.support.programs import ROOT

OLDEST = (1, 32)
# each is there twice, strict and not
VERSIONS = [
    text for text in dict.fromkeys(all_versions()) if tuple(int(part) for part in text.split(".")[:2]) >= OLDEST
]
# of Kubernetes itself: no ingress controller, no resource of k3s
KINDS = {
    "v1": {"Namespace", "ServiceAccount", "ConfigMap", "Service", "PersistentVolumeClaim"},
    "apps/v1": WORKLOADS,
    "batch/v1": {"CronJob"},
    "networking.k8s.io/v1": {"NetworkPolicy"},
}
IMAGES = ("webserver", "rosberry", "sim")


def validate(manifests: Manifests, kubernetes: str) -> None:
    for item in manifests.objects:
        kubernetes_validate.validate(item, kubernetes, strict=True)


@pytest.mark.parametrize(
    "kubernetes",
    [VERSIONS[0], *(pytest.param(each, marks=pytest.mark.slow) for each in VERSIONS[1:-1]), VERSIONS[-1]],
)
def test_every_object_fits_the_schemas_of_kubernetes(manifests: Manifests, kubernetes: str) -> None:
    validate(manifests, kubernetes)


def test_the_k3s_that_the_readme_installs_is_a_version_that_these_manifests_are_checked_for() -> None:
    (minor,) = re.findall(r"k3s_version: v(1\.\d+)\.\d+\+k3s\d+$", kubernetes_pages(), re.MULTILINE)
    assert minor in {".".join(version.split(".")[:2]) for version in VERSIONS}


def test_the_schemas_cover_the_versions_that_k3s_ships() -> None:
    assert VERSIONS[0].startswith("1.32.")
    assert len(VERSIONS) >= 4


def test_the_optional_parts_of_lan_may_be_uncommented(tmp_path: Path, customize: Customize) -> None:
    shutil.copytree(ROOT / "k3s", tmp_path / "k3s")
    file = tmp_path / "k3s/overlays/lan/kustomization.yaml"
    text, lines = re.subn(r"^  # - ", "  - ", file.read_text(), flags=re.MULTILINE)
    assert lines == 1
    file.write_text(text)
    assert specs(Manifests(file.parent)) == specs(customize("lan", "device-plugin"))


def specs(manifests: Manifests) -> list[tuple[object, ...]]:
    return [
        (item["kind"], item["metadata"]["name"], item["metadata"].get("namespace"), item.get("spec"))
        for item in manifests.objects
    ]


OPTIONAL = [
    ("lan", "device-plugin"),
    ("sim", "kept-data"),
    *itertools.product(("lan", "sim"), ("front", "monitoring")),
]


@pytest.mark.parametrize(("base", "component"), OPTIONAL)
def test_each_optional_part_is_in_a_namespace_that_is_made_with_it(
    customize: Customize, base: str, component: str
) -> None:
    test_every_object_is_in_a_namespace_that_is_made_with_it(customize(base, component))


@pytest.mark.parametrize(("base", "component"), OPTIONAL)
def test_each_optional_part_fits_the_schemas_too(customize: Customize, base: str, component: str) -> None:
    changed = customize(base, component)
    assert changed.objects != overlay(base).objects
    for kubernetes in (VERSIONS[0], VERSIONS[-1]):
        validate(changed, kubernetes)


def test_the_schemas_refuse_what_is_wrong(customize: Customize) -> None:
    patch = {
        "target": {"kind": "Service", "name": "master"},
        "patch": '[{"op": "add", "path": "/spec/prots", "value": 1}]',
    }
    with pytest.raises(kubernetes_validate.ValidationError, match="prots"):
        validate(customize("sim", patches=[patch]), VERSIONS[0])


@pytest.mark.parametrize("program", ["rosbridge", "web", "camera-relay"])
def test_the_example_of_the_secret_fits_what_the_programs_ask_for(program: str) -> None:
    example = yaml.safe_load((ROOT / "k3s/base/secret.example.yaml").read_text())
    kubernetes_validate.validate(example, VERSIONS[0], strict=True)
    (asking,) = [container for _, container in overlay("sim").containers if container["name"] == program]
    (token,) = [item for item in asking["env"] if item["name"] == "LASERBOT_OPERATOR_TOKEN"]
    reference = token["valueFrom"]["secretKeyRef"]
    assert reference["name"] == example["metadata"]["name"]
    assert reference["key"] in example["stringData"]


def test_only_kinds_that_every_cluster_has(manifests: Manifests) -> None:
    for item in manifests.objects:
        assert item["kind"] in KINDS[item["apiVersion"]]
        assert item["spec"].get("type") != "LoadBalancer" if item["kind"] == "Service" else True


def test_what_others_need_comes_first(manifests: Manifests) -> None:
    kinds = [item["kind"] for item in manifests.objects]
    first = kinds.index(next(kind for kind in kinds if kind in WORKLOADS))
    needed = {"Namespace", "ServiceAccount", "ConfigMap", "Service", "PersistentVolumeClaim"}
    assert not needed & set(kinds[first:])
    assert set(kinds[: len(manifests.namespaces)]) == {"Namespace"}


def test_every_object_is_in_a_namespace_that_is_made_with_it(manifests: Manifests) -> None:
    for item in manifests.objects:
        if item["kind"] != "Namespace":
            assert item["metadata"]["namespace"] in manifests.namespaces


def test_images_are_of_this_version_and_may_be_loaded_by_hand(manifests: Manifests) -> None:
    for _, container in manifests.containers:
        name, _, tag = container["image"].partition(":")
        assert name in IMAGES
        assert tag == version()
        assert container["imagePullPolicy"] == "IfNotPresent"


@pytest.mark.parametrize("name", OVERLAYS)
@pytest.mark.parametrize("image", IMAGES)
def test_one_entry_replaces_an_image_everywhere(customize: Customize, name: str, image: str) -> None:
    entry = {"name": image, "newName": f"laser-bot-master.local:5443/{image}", "newTag": "9"}
    before = [container["image"] for _, container in overlay(name).containers]
    after = [container["image"] for _, container in customize(name, images=[entry]).containers]
    assert after == [re.sub(f"^{image}:.*", f"laser-bot-master.local:5443/{image}:9", text) for text in before]


def test_a_pod_is_placed_only_where_its_images_run(manifests: Manifests) -> None:
    every = {"amd64", "arm64", "arm"}
    for pod, container in manifests.containers:
        terms = pod.get("affinity", {}).get("nodeAffinity", {}).get("requiredDuringSchedulingIgnoredDuringExecution")
        allowed = set(terms["nodeSelectorTerms"][0]["matchExpressions"][0]["values"]) if terms else every
        has = {platform.split("/")[1] for platform in platforms(container["image"].partition(":")[0])}
        assert allowed <= has
        assert has & every <= allowed


def test_arenas_differ_in_nothing_but_namespace_and_ports() -> None:
    both = overlay("arenas")
    names = both.namespaces
    assert len(names) == 2

    def neutral(namespace: str) -> str:
        text = str(both.within(namespace).objects).replace(namespace, "NAMESPACE")
        text = re.sub(r"(settings|logging|arena|positions|robot|bot)-[a-z0-9]{10}", r"\1", text)
        return re.sub(r"\b3\d{4}\b", "PORT", text)

    assert neutral(names[0]) == neutral(names[1])


def test_the_number_of_robots_is_one_value(customize: Customize) -> None:
    changed = customize("sim", replicas=[{"name": "robot", "count": 4}])
    assert changed.one("StatefulSet", "robot")["spec"]["replicas"] == 4


def test_the_readmes_example_changes_what_it_says(tmp_path: Path) -> None:
    text = kubernetes_pages()
    example = next(
        content
        for block in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
        if (content := yaml.safe_load(block)).get("kind") == "Kustomization"
    )
    up = os.path.relpath(ROOT, tmp_path)
    for field in ("resources", "components"):
        example[field] = [path.replace("../laser_bot_battle", up) for path in example[field]]
    (tmp_path / "kustomization.yaml").write_text(yaml.safe_dump(example))
    changed = Manifests(tmp_path)
    settings = changed.config("settings")
    assert settings["data"]["LASERBOT_BATTLE_LIMIT"] == "600"
    assert "raspberrypi3=3" in settings["data"]["LASERBOT_ROSTER"]
    assert all(container["image"].startswith("192.168.1.20:5000/") for _, container in changed.containers)


def test_what_an_arena_requests_is_what_the_readme_reckons_with() -> None:
    def requested(workload: dict[str, Any]) -> tuple[int, int]:
        """Thousandths of a core, and MiB."""
        asked = [each["resources"]["requests"] for each in workload["spec"]["template"]["spec"]["containers"]]
        cores = sum(int(each["cpu"].removesuffix("m")) for each in asked)
        return cores, sum(int(each["memory"].removesuffix("Mi")) for each in asked)

    text = " ".join(kubernetes_pages().split())
    workloads = {each["metadata"]["name"]: requested(each) for each in overlay("sim").workloads}
    robot = workloads.pop("robot")
    cores, memory = (sum(column) for column in zip(*workloads.values(), strict=True))
    said = f"requests {cores / 1000:g} of a core and {memory} MiB, and each virtual robot {robot[0] / 1000:g} of a core"
    assert f"{said} and {robot[1]} MiB more" in text

    def together(arenas: int, robots: int) -> tuple[str, int]:
        """Cores, and MiB, of so many arenas with so many robots each."""
        return f"{arenas * (cores + robots * robot[0]) / 1000:.1f} cores", arenas * (memory + robots * robot[1])

    for words, arenas, robots in (("three arenas of two robots", 3, 2), ("two of four", 2, 4)):
        needed, mebibytes = together(arenas, robots)
        assert f"{words} ({needed}, {mebibytes / 1024:.1f} GiB)" in text
    needed, mebibytes = together(1, 2)
    assert f"two cores and 2 GiB carries one arena of two robots ({needed}, {mebibytes} MiB)" in text
    assert mebibytes <= 2048 - 1024, "k3s, its own pods and the system have the rest"


@pytest.mark.parametrize(
    ("name", "components"), [("lan", ("camera", "front", "monitoring", "leaderboard")), ("sim", ())]
)
def test_one_line_names_the_registry_of_all_images(
    name: str, components: tuple[str, ...], customize: Customize
) -> None:
    before = customize(name, *components)
    registry = {"name": "registry", "literals": ["address=registry.example:5000/laserbot"]}
    after = customize(name, *components, "registry", configMapGenerator=[registry])
    assert [container["image"] for _, container in after.containers] == [
        container["image"]
        if container["image"].startswith("postgres:")
        else f"registry.example:5000/laserbot/{container['image']}"
        for _, container in before.containers
    ]
