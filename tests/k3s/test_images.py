"""k3s/images.py: pods are replaced when, and only when, their image has changed; a cluster's images can be checked."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.k3s.conftest import Customize
from tests.support.archive import Archive
from tests.support.documents import kubernetes_pages
from tests.support.imagefile import version
from tests.support.manifests import OVERLAYS, Manifests, Object, customized, overlay
from tests.support.programs import ROOT

README = kubernetes_pages()
PROGRAM = ROOT / "k3s/images.py"
REGISTRY = "192.168.1.20:5000"


def run(*words: str | Path, given: str = "") -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(PROGRAM), *map(str, words)]
    return subprocess.run(command, input=given, capture_output=True, text=True, check=False)


def named(archive: Archive, *registry: str) -> Object:
    """The component that names the archive's images."""
    done = run("name", archive.path, *registry)
    assert done.returncode == 0, done.stderr
    content: Object = yaml.safe_load(done.stdout)
    return content


def templates(manifests: Manifests) -> dict[tuple[str, str, str], Object]:
    return {
        (each["kind"], each["metadata"]["namespace"], each["metadata"]["name"]): each["spec"]["template"]
        for each in manifests.workloads
    }


def with_images(customize: Customize, name: str, component: Object, *components: str) -> Manifests:
    return customize(name, *components, images=component["images"])


@pytest.mark.parametrize("name", OVERLAYS)
def test_every_image_of_ours_is_named_by_what_is_in_it(customize: Customize, tmp_path: Path, name: str) -> None:
    archive = Archive(tmp_path / "laserbot.tar")
    by_tag = with_images(customize, name, named(archive))
    by_digest = with_images(customize, name, named(archive, REGISTRY))
    for (_, before), (_, tag), (_, digest) in zip(
        overlay(name).containers, by_tag.containers, by_digest.containers, strict=True
    ):
        image = before["image"].partition(":")[0]
        held = archive.digests[image]
        assert tag["image"] == f"{image}:{version()}-{held.replace(':', '-')}"
        assert digest["image"] == f"{REGISTRY}/{image}@{held}"
    held = archive.digests["webserver"]
    for job in by_digest.of("CronJob"):  # the backups': none starts an older program than the master's
        assert f"'image': '{REGISTRY}/webserver@{held}'" in str(job)


def test_it_is_a_component_that_kustomize_takes(customize: Customize, tmp_path: Path) -> None:
    archive = Archive(tmp_path / "laserbot.tar")
    content = named(archive)
    (tmp_path / "images").mkdir()
    (tmp_path / "images/kustomization.yaml").write_text(run("name", archive.path).stdout)
    own = customize("sim", components=["images"])
    assert templates(own) == templates(with_images(customize, "sim", content))


def test_a_pod_is_replaced_when_its_image_has_changed_and_no_other(customize: Customize, tmp_path: Path) -> None:
    first = with_images(customize, "sim", named(Archive(tmp_path / "1.tar")))
    same = with_images(customize, "sim", named(Archive(tmp_path / "2.tar")))
    assert templates(first) == templates(same)
    rebuilt = with_images(customize, "sim", named(Archive(tmp_path / "3.tar", {"webserver": "rebuilt"})))
    replaced = {key[2] for key, template in templates(first).items() if templates(rebuilt)[key] != template}
    assert replaced == {"master", "bot"}
    rebuilt = with_images(customize, "sim", named(Archive(tmp_path / "4.tar", {"sim": "rebuilt"})))
    replaced = {key[2] for key, template in templates(first).items() if templates(rebuilt)[key] != template}
    assert replaced == {"arena", "robot"}


@pytest.mark.parametrize("way", ["bare", "registry", "component"])
def test_the_names_of_rendered_manifests_are_replaced_with_their_registry(tmp_path: Path, way: str) -> None:
    """As ansible/k3s.yml does: `component` is of an earlier archive in a registry."""
    archive = Archive(tmp_path / "laserbot.tar")
    ways: dict[str, dict[str, Any]] = {
        "bare": {"components": []},
        "registry": {"configMapGenerator": [{"name": "registry", "literals": [f"address={REGISTRY}"]}]},
        "component": {"images": named(Archive(tmp_path / "1.tar", {"webserver": "older"}), REGISTRY)["images"]},
    }
    for folder in ("own", "by-digest"):
        (tmp_path / folder).mkdir()
    before = customized(tmp_path / "own", "lan", *(["registry"] if way == "registry" else []), **ways[way])
    done = run("name", archive.path, "-", given=yaml.safe_dump_all(before.objects))
    assert done.returncode == 0, done.stderr
    content = {"resources": ["../own"], "images": yaml.safe_load(done.stdout)["images"]}
    (tmp_path / "by-digest/kustomization.yaml").write_text(yaml.safe_dump(content))
    after = Manifests(tmp_path / "by-digest")
    assert {container["image"] for _, container in after.containers} == {
        f"{name}:{version()}-{archive.digests[name].replace(':', '-')}"
        if way == "bare"
        else f"{REGISTRY}/{name}@{archive.digests[name]}"
        for name in ("webserver", "rosberry")
    }


def pod(name: str, images: dict[str, tuple[str, str]], **metadata: object) -> Object:
    """As kubectl gives it; of each container the image that its manifest names, and what runs."""
    return {
        "metadata": {"namespace": "laserbot", "name": name, **metadata},
        "spec": {"containers": [{"name": each, "image": image} for each, (image, _) in images.items()]},
        "status": {
            "phase": "Running",
            "containerStatuses": [{"name": each, "imageID": runs} for each, (_, runs) in images.items()],
        },
    }


def workload(kind: str, namespace: str, name: str, wanted: int) -> Object:
    """As kubectl gives it; `wanted` are its pods."""
    many: Object = {"status": {"desiredNumberScheduled": wanted}} if kind == "DaemonSet" else {}
    return {
        "kind": kind,
        "metadata": {"namespace": namespace, "name": name},
        "spec": {"selector": {"matchLabels": {"name": name}}} | ({} if many else {"replicas": wanted}),
        **many,
    }


def compared(archive: Archive, *found: Object, within: tuple[str, ...] = ()) -> tuple[int, list[str]]:
    done = run("check", archive.path, *within, given=json.dumps({"items": found}))
    return done.returncode, (done.stdout + done.stderr).splitlines()


@pytest.mark.parametrize(
    "form",
    [
        pytest.param("{settings}", id="containerd, imported"),
        pytest.param("docker.io/library/webserver@{digest}", id="containerd, pulled"),
        pytest.param("192.168.1.20:5000/webserver@{manifest}", id="of one platform"),
        pytest.param("docker-pullable://192.168.1.20:5000/webserver@{digest}", id="Docker"),
    ],
)
@pytest.mark.parametrize("platform", ["amd64", "arm64"])
def test_what_was_built_is_known_by_each_of_its_names(tmp_path: Path, form: str, platform: str) -> None:
    archive, old = Archive(tmp_path / "new.tar"), Archive(tmp_path / "old.tar", {"webserver": "older"})

    def runs(of: Archive) -> str:
        key = ("webserver", platform)
        return form.format(digest=of.digests["webserver"], manifest=of.manifests[key], settings=of.settings[key])

    image = f"{REGISTRY}/webserver:{version()}"
    code, said = compared(archive, pod("master-1", {"web": (image, runs(archive))}))
    assert (code, said) == (0, ["every container runs its image of the archive"])
    code, (line,) = compared(archive, pod("master-1", {"web": (image, runs(old))}))
    assert code == 1
    assert line.startswith("laserbot/master-1 web: runs sha256:")
    assert line.endswith(f"wanted is webserver {archive.digests['webserver']}")


def test_only_what_should_run_is_compared(tmp_path: Path) -> None:
    archive = Archive(tmp_path / "laserbot.tar")
    other = f"sha256:{'0' * 64}"
    ending = pod("master-1", {"web": ("webserver:1.0.0", other)}, deletionTimestamp="2026-01-01T00:00:00Z")
    done = pod("backup-1", {"backup": ("webserver:1.0.0", other)})
    done["status"]["phase"] = "Succeeded"
    database = pod("leaderboard-0", {"postgres": ("postgres:17", other)})
    assert compared(archive, ending, done, database)[0] == 0
    waiting = pod("robot-0", {"arduino": ("sim:1.0.0", ""), "robot": ("rosberry:1.0.0", other)})
    code, lines = compared(archive, waiting)
    assert code == 1
    assert [line.split(":")[0] for line in lines] == ["laserbot/robot-0 arduino", "laserbot/robot-0 robot"]
    assert "has not started" in lines[0]


KINDS = ("Deployment", "StatefulSet", "DaemonSet")


@pytest.mark.parametrize("kind", KINDS)
def test_only_where_pods_are_wanted_none_is_a_fault(tmp_path: Path, kind: str) -> None:
    archive = Archive(tmp_path / "laserbot.tar")
    assert compared(archive, workload(kind, "laserbot", "robot", 0))[0] == 0
    wanting = workload(kind, "laserbot", "robot", 2)
    fault = (1, ["laserbot/robot: has no pods; wanted are 2"])
    master = pod("master-1", {"web": ("webserver", archive.digests["webserver"])}, labels={"name": "master"})
    assert compared(archive, wanting, master) == fault
    robot = pod("robot-1", {"robot": ("rosberry", archive.digests["rosberry"])}, labels={"name": "robot", "hash": "1"})
    assert compared(archive, wanting, robot | {"metadata": robot["metadata"] | {"namespace": "other"}}) == fault
    assert compared(archive, wanting, master, robot)[0] == 0


def test_namespaces_without_anything_of_the_game_are_left_alone(tmp_path: Path) -> None:
    archive = Archive(tmp_path / "laserbot.tar")
    right = pod("master-1", {"web": ("webserver", archive.digests["webserver"])})
    wrong = pod("master-1", {"web": ("webserver", f"sha256:{'0' * 64}")}, namespace="another-game")
    assert compared(archive, right, wrong)[0] == 1
    assert compared(archive, right, wrong, within=("laserbot", "own"))[0] == 0
    code, (line,) = compared(archive, wrong, within=("laserbot", "own"))
    assert code == 2
    assert "there are no pods to compare in laserbot, own: " in line


NO_REGISTRIES = (f"http://{REGISTRY}", f"{REGISTRY}/", "my_registry:5000")  # containerd takes no _ in a host


def test_bad_input_gets_one_line(tmp_path: Path) -> None:
    plain = Archive(tmp_path / "plain.tar", by_digest=False).path
    good = Archive(tmp_path / "good.tar").path
    (tmp_path / "text.tar").write_text("no archive")
    pods = json.dumps({"items": []})
    faults: list[tuple[tuple[Any, ...], str, str]] = [
        ((), "", "usage: "),
        (("name",), "", "usage: "),
        (("name", tmp_path / "none.tar"), "", "No such file"),
        (("name", tmp_path / "text.tar"), "", "is no archive of images"),
        (("name", plain), "", "does not name monitoring rosberry sim webserver by digest"),
        *((("name", good, wrong), "", f"{wrong} is no registry: it must be like ") for wrong in NO_REGISTRIES),
        (
            ("name", good, "-"),
            "image: postgres:17",
            "the manifests name none of monitoring rosberry sim webserver; put ",
        ),
        (("check", good), pods, "there are no pods to compare"),
        (("check", good), "NAME READY", "is not the output of kubectl get pods"),
    ]
    for words, given, message in faults:
        done = run(*words, given=given)
        assert (done.returncode, done.stdout) == (2, "")
        (line,) = done.stderr.splitlines()
        assert message in line


def test_the_readmes_commands_are_the_programs() -> None:
    assert "k3s/images.py name ../laser_bot_battle/laserbot.tar >" in README
    assert "k3s/images.py name ../laser_bot_battle/laserbot.tar 192.168.1.20:5000 >" in README
    assert "k3s/images.py check ../laser_bot_battle/laserbot.tar" in README
