"""The README's examples for Flux and Argo CD, and their kustomization with a remote base."""

import json
import re
import subprocess
from pathlib import Path

import pytest
import yaml

from tests.support.crds import problems
from tests.support.documents import kubernetes_pages
from tests.support.imagefile import version
from tests.support.manifests import WORKLOADS, Manifests, Object, overlay
from tests.support.programs import ROOT

README = kubernetes_pages()
SECTION = README.partition("## By Git with Flux or Argo CD\n")[2].partition("\n## ")[0]
BLOCKS: list[list[Object]] = [
    list(yaml.safe_load_all(block)) for block in re.findall(r"```yaml\n(.*?)```", SECTION, re.DOTALL)
]


def of(group: str) -> list[Object]:
    return [item for block in BLOCKS for item in block if group in item["apiVersion"]]


@pytest.mark.parametrize("group", ["fluxcd.io", "argoproj.io"])
def test_the_examples_fit_the_definitions_of_their_makers(group: str) -> None:
    examples = of(group)
    assert examples
    assert problems(*examples) == []
    (block,) = [text for text in re.findall(r"```yaml\n(.*?)```", SECTION, re.DOTALL) if group in text]
    assert len(block.splitlines()) <= 10


def test_they_apply_a_folder_with_the_kustomization() -> None:
    (source,), (application,) = of("source.toolkit.fluxcd.io"), of("argoproj.io")
    (flux,) = of("kustomize.toolkit.fluxcd.io")
    assert flux["spec"]["sourceRef"] == {"kind": "GitRepository", "name": source["metadata"]["name"]}
    assert source["spec"]["url"] == application["spec"]["source"]["repoURL"]
    assert flux["spec"]["path"].removeprefix("./") == application["spec"]["source"]["path"]


def test_flux_waits_for_nothing_that_may_be_pending_for_hours() -> None:
    """As the claim of components/backups is, until the first backup."""
    (flux,) = of("kustomize.toolkit.fluxcd.io")
    assert not flux["spec"].get("wait"), "it would stand in for healthChecks"
    for check in flux["spec"]["healthChecks"]:
        assert check["kind"] in WORKLOADS
        found = overlay("sim").one(check["kind"], check["name"])
        assert (check["apiVersion"], check["namespace"]) == (found["apiVersion"], found["metadata"]["namespace"])


def test_what_heals_itself_can_be_suspended_and_resumed() -> None:
    """The commands' patches, applied to the examples: after the second one all is as before."""
    patches = re.findall(
        r"^kubectl --namespace (\S+) patch (\w+) (\w+) --type merge --patch '(.*)'$", SECTION, re.MULTILINE
    )
    for group in ("kustomize.toolkit.fluxcd.io", "argoproj.io"):
        (example,) = of(group)
        where = (example["metadata"]["namespace"], example["kind"].lower(), example["metadata"]["name"])
        suspend, resume = (json.loads(patch[3])["spec"] for patch in patches if patch[:3] == where)
        suspended = merged(example["spec"], suspend)
        assert suspended.get("suspend") or not suspended["syncPolicy"]
        assert problems({**example, "spec": suspended}) == []
        assert {"suspend": False, **example["spec"]} == {"suspend": False, **merged(suspended, resume)}


def merged(into: Object, patch: Object) -> Object:
    """JSON Merge Patch (RFC 7386)."""
    found = {**into}
    for key, value in patch.items():
        if value is None:
            found.pop(key, None)
        else:
            found[key] = merged(found.get(key, {}), value) if isinstance(value, dict) else value
    return found


def test_the_remote_base_is_this_versions_tag_and_gives_the_same_objects(tmp_path: Path) -> None:
    """With a clone of this repository in the place of the one that the README names."""
    (own,) = of("kustomize.config.k8s.io")
    (base,) = own["resources"]
    address, path, tag = re.fullmatch(r"(https://.*?)//(.*)\?ref=(.*)", base).groups()  # type: ignore[union-attr]
    assert tag == f"v{version()}"
    (tmp_path / "repository").mkdir()
    for words in (
        ("init", "--quiet", "--initial-branch=main"),
        ("add", "."),
        ("-c", "user.name=a", "-c", "user.email=a@b.example", "commit", "--quiet", "--message=all"),
        ("tag", tag),
    ):
        if words[0] == "add":
            subprocess.run(["cp", "-r", ROOT / "k3s", tmp_path / "repository/k3s"], check=True)
        subprocess.run(["git", *words], cwd=tmp_path / "repository", check=True)
    here = base.replace(address, f"file://{tmp_path / 'repository'}")
    (tmp_path / "own").mkdir()
    content = {**own, "resources": [here]}
    (tmp_path / "own/kustomization.yaml").write_text(yaml.safe_dump(content))
    fetched = Manifests(tmp_path / "own")
    name = Path(path).name
    assert [item["metadata"]["name"] for item in fetched.objects] == [
        item["metadata"]["name"] for item in overlay(name).objects
    ]
    images = {each["name"]: f"{each['newName']}@{each['digest']}" for each in own["images"]}
    assert {container["image"] for _, container in fetched.containers} <= set(images.values())
