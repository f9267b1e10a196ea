#!/usr/bin/env python3
"""Names the images of an archive by what is in them, and tells whether a cluster runs those.

    k3s/images.py name ARCHIVE [REGISTRY]

prints a kustomize component: Kubernetes then starts these images and no others of the same version. With REGISTRY, it
takes them from there. With - in its place, the names are those of the manifests at standard input, which may have
a registry in front.

    kubectl get pods --all-namespaces --selector app.kubernetes.io/part-of=laserbot --output json |
        k3s/images.py check ARCHIVE [NAMESPACE...]

says which containers run something else, in these namespaces or in all: exit code 1 if there are any. With
deployments,statefulsets,daemonsets,pods in place of pods, it also says which of these should have pods and have none,
and takes no pods for right where none are wanted.

`make images ARCHIVE=...` writes the archive; Python's standard library is all that this program needs.
"""

import json
import re
import sys
import tarfile
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

DIGEST = re.compile(r"sha256:[0-9a-f]{64}")
FIELD = "io.containerd.image.name"
REGISTRY = re.compile(r"(?:[A-Za-z0-9.-]+|\[[0-9a-f:]+\])(?::[0-9]+)?(?:/[a-z0-9._-]+)*")
WORKLOADS = {"Deployment", "StatefulSet", "DaemonSet"}
IMAGE_LINE = re.compile(r"""^[ -]*image: ["']?([^\s"']+)""", re.MULTILINE)

Entry = dict[str, str]  # of kustomize's `images`
Object = Mapping[str, Any]  # as kubectl gives it


class InputError(Exception):
    """What the user should be told, in one line."""


@dataclass(frozen=True)
class Image:
    """One image for all its platforms."""

    name: str
    version: str
    digest: str
    parts: frozenset[str]  # the digests by which a cluster may know it: its own, and for each platform two

    @property
    def tag(self) -> str:
        """The archive's second tag for it. A tag has no colon."""
        return f"{self.version}-{self.digest.replace(':', '-')}"


def read(archive: Path) -> dict[str, Image]:
    """The images of an archive by name; InputError if it is none, or names them only by their version."""
    try:
        with tarfile.open(archive) as tar:
            entries = _json(tar, "index.json")["manifests"]
            tags: dict[str, set[str]] = {}
            for entry in entries:
                name, _, tag = entry["annotations"][FIELD].rpartition("/")[2].partition(":")
                tags.setdefault(name, set()).add(tag)
            images = {}
            for entry in entries:
                name, _, tag = entry["annotations"][FIELD].rpartition("/")[2].partition(":")
                image = Image(name, tag, entry["digest"], frozenset(_parts(tar, entry["digest"])))
                if image.tag in tags[name]:
                    images[name] = image
    except OSError as error:
        raise InputError(f"cannot read {archive}: {error.strerror or error}") from None
    except (tarfile.TarError, KeyError, TypeError, ValueError):
        raise InputError(f"{archive} is no archive of images; make images ARCHIVE={archive} writes one") from None
    missing = tags.keys() - images.keys()
    if missing or not images:
        raise InputError(
            f"{archive} does not name {' '.join(sorted(missing)) or 'any image'} by digest; write it anew: "
            f"make images ARCHIVE={archive}"
        )
    return images


def _json(tar: tarfile.TarFile, name: str) -> Any:
    file = tar.extractfile(name)
    if file is None:
        raise KeyError(name)
    return json.load(file)


def _parts(tar: tarfile.TarFile, digest: str) -> Iterator[str]:
    """A container runtime names what it runs by the digest of the whole, or of a platform's manifest or settings."""
    yield digest
    try:
        content = _json(tar, f"blobs/{digest.replace(':', '/')}")
    except KeyError:
        return  # an archive may have some platforms only
    for manifest in content.get("manifests", []):
        yield from _parts(tar, manifest["digest"])
    if "config" in content:
        yield content["config"]["digest"]


def named(images: Mapping[str, Image], registry: str = "") -> list[Entry]:
    """Each image by its digest: in a registry as usual, else by its second tag. InputError: that is no registry."""
    if registry and not REGISTRY.fullmatch(registry):
        raise InputError(f"{registry} is no registry: it must be like 192.168.1.20:5000 or registry.example/games")
    return [_entry(image, name, f"{registry}/{name}" if registry else "") for name, image in sorted(images.items())]


def renamed(images: Mapping[str, Image], manifests: str) -> list[Entry]:
    """The same for the names in these manifests: kustomize knows an image only with its registry.

    InputError if none is of the archive.
    """
    found = sorted({name for name in map(_name, IMAGE_LINE.findall(manifests)) if _last(name) in images})
    if not found:
        raise InputError(
            f"the manifests name none of {' '.join(sorted(images))}; put into their kustomization what this prints: "
            "k3s/images.py name ARCHIVE REGISTRY"
        )
    return [_entry(images[_last(name)], name, name if "/" in name else "") for name in found]


def _entry(image: Image, name: str, remote: str) -> Entry:
    return {"name": name, "newName": remote, "digest": image.digest} if remote else {"name": name, "newTag": image.tag}


def component(entries: Iterable[Entry], source: str) -> str:
    """A kustomization.yaml with these entries."""
    return "\n".join(
        [
            f"# Written by k3s/images.py: the images of {source}, by digest.",
            "apiVersion: kustomize.config.k8s.io/v1alpha1",
            "kind: Component",
            "images:",
            *(f"  - {json.dumps(entry)}" for entry in entries),
            "",
        ]
    )


def _name(image: str) -> str:
    """Without tag and digest; a registry may have a port."""
    before, slash, last = image.rpartition("/")
    return f"{before}{slash}{re.split('[:@]', last)[0]}"


def _last(name: str) -> str:
    """Without the registry."""
    return name.rpartition("/")[2]


def others(pods: Iterable[Object], images: Mapping[str, Image]) -> Iterator[str]:
    """A line for each container of these pods that runs another image of the same name.

    Pods that are ending, or have ended as those of jobs do, are left out.
    """
    for pod in pods:
        status = pod.get("status", {})
        if "deletionTimestamp" in pod["metadata"] or status.get("phase") in {"Succeeded", "Failed"}:
            continue
        running = {
            each["name"]: each.get("imageID", "")
            for kind in ("initContainerStatuses", "containerStatuses")
            for each in status.get(kind) or ()
        }
        for container in (*pod["spec"].get("initContainers", ()), *pod["spec"]["containers"]):
            image = images.get(_last(_name(container["image"])))
            if image is None:
                continue  # PostgreSQL, or of your own
            where = f"{pod['metadata']['namespace']}/{pod['metadata']['name']} {container['name']}"
            found = DIGEST.search(running.get(container["name"], ""))
            if found is None:
                yield f"{where}: has not started; wanted is {image.name} {image.digest}"
            elif found[0] not in image.parts:
                yield f"{where}: runs {found[0]}; wanted is {image.name} {image.digest}"


def without_pods(workloads: Iterable[Object], pods: Sequence[Object]) -> Iterator[str]:
    """A line for each of these workloads that should have pods and has none, not even one that is ending."""
    for workload in workloads:
        wanted = _wanted(workload)
        if wanted and not any(_has(workload, pod) for pod in pods):
            metadata = workload["metadata"]
            yield f"{metadata['namespace']}/{metadata['name']}: has no pods; wanted are {wanted}"


def _wanted(workload: Object) -> int:
    """How many pods; of a DaemonSet, one for each node that it fits."""
    if workload["kind"] == "DaemonSet":
        return int(workload.get("status", {}).get("desiredNumberScheduled", 0))
    return int(workload["spec"].get("replicas", 1))


def _has(workload: Object, pod: Object) -> bool:
    selected: dict[str, str] = workload["spec"]["selector"].get("matchLabels", {})
    labels: dict[str, str] = pod["metadata"].get("labels", {})
    is_beside = bool(pod["metadata"]["namespace"] == workload["metadata"]["namespace"])
    return is_beside and selected.items() <= labels.items()


def check(text: str, images: Mapping[str, Image], namespaces: Collection[str] = ()) -> list[str]:
    """As `without_pods` and `others`, of kubectl's output; InputError if that has nothing in these namespaces."""
    try:
        items = [
            item for item in json.loads(text)["items"] if not namespaces or item["metadata"]["namespace"] in namespaces
        ]
        if not items:
            where = f" in {', '.join(namespaces)}" if namespaces else ""
            raise InputError(f"there are no pods to compare{where}: is the game in another cluster or namespace?")
        workloads = [item for item in items if item.get("kind") in WORKLOADS]
        pods = [item for item in items if item.get("kind") not in WORKLOADS]
        return [*without_pods(workloads, pods), *others(pods, images)]
    except (ValueError, KeyError, TypeError, AttributeError):
        raise InputError("the input is not the output of kubectl get pods --output json") from None


def main(words: list[str]) -> int:
    try:
        match words:
            case ["name", archive, "-"]:
                print(component(renamed(read(Path(archive)), sys.stdin.read()), archive), end="")
                return 0
            case ["name", archive, *registry] if len(registry) < 2:
                print(component(named(read(Path(archive)), *registry), archive), end="")
                return 0
            case ["check", archive, *namespaces]:
                wrong = check(sys.stdin.read(), read(Path(archive)), namespaces)
                print("\n".join(wrong) or "every container runs its image of the archive")
                return 1 if wrong else 0
        raise InputError(
            "usage: k3s/images.py name ARCHIVE [REGISTRY or -], or k3s/images.py check ARCHIVE [NAMESPACE...] <PODS"
        )
    except InputError as error:
        print(f"k3s/images.py: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
