"""The settings in Kubernetes' manifests: what each container gets, and what no container here reads."""

import base64
import binascii
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import yaml

from laser_bot_battle.given_settings import Given, Group

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the one in C takes a tenth of the time
_HOLDERS = ("ConfigMap", "Secret")
# what has a pod, by Kubernetes' own names: the fields of other projects' objects may mean anything
_WITH_PODS = ("Pod", "Deployment", "StatefulSet", "DaemonSet", "ReplicaSet", "Job", "CronJob")
_REFERENCE = re.compile(r"\$\(([^()]+)\)")

Object = dict[str, Any]
Place = tuple[str, str | None, str]  # kind, namespace, name


def groups(text: str) -> list[Group]:
    """ValueError if it is no YAML of manifests."""
    try:
        objects = [item for document in yaml.load_all(text, Loader=_LOADER) for item in _items(document)]
    except yaml.YAMLError as error:
        raise ValueError(f"it is no YAML: {error}") from None
    held: dict[Place, dict[str, Given]] = {}
    for item in objects:
        if item["kind"] in _HOLDERS:
            with _told(item):
                held[_place(item)] = _data(item)
    read: set[Place] = set()
    found: list[Group] = []
    for item in objects:
        if item["kind"] in _WITH_PODS:
            with _told(item):
                found += [_Container(item, container, held, read).group() for container in _containers(item)]
    return [*found, *(data for place, data in held.items() if place not in read)]


@contextmanager
def _told(item: Object) -> Iterator[None]:
    """ValueError for fields that are missing or of another kind than Kubernetes wants."""
    try:
        yield
    except (AttributeError, KeyError, TypeError):
        raise ValueError(f"{_named(item)} is not as Kubernetes wants it") from None


class _Container:
    """One container, with the ConfigMaps and Secrets that are `held` here; `read` is told which it names."""

    def __init__(self, owner: Object, container: Object, held: dict[Place, dict[str, Given]], read: set[Place]) -> None:
        self._namespace = owner["metadata"].get("namespace")
        self._where = f"{_named(owner)}, container {container.get('name')}: "
        self._container, self._held, self._read = container, held, read

    def group(self) -> Group:
        found: dict[str, Given] = {}
        for source in self._container.get("envFrom") or []:
            for kind, key in (("ConfigMap", "configMapRef"), ("Secret", "secretRef")):
                prefix = source.get("prefix", "")
                held = self._of(kind, source[key]["name"]) if key in source else {}
                found |= {prefix + name: given for name, given in held.items()}
        for variable in self._container.get("env") or []:
            given = self._value(variable, found)
            if given:
                found[variable["name"]] = given
        return found

    def _of(self, kind: str, name: str) -> dict[str, Given]:
        place = (kind, self._namespace, name)
        self._read.add(place)
        return self._held.get(place, {})

    def _value(self, variable: Object, found: dict[str, Given]) -> Given | None:
        if "valueFrom" not in variable:
            text = _REFERENCE.sub(
                lambda match: found[match[1]].value if match[1] in found else match[0], str(variable.get("value") or "")
            )
            return Given(text, self._where)
        source = variable["valueFrom"]
        for kind, key in (("ConfigMap", "configMapKeyRef"), ("Secret", "secretKeyRef")):
            if key in source:
                return self._of(kind, source[key]["name"]).get(source[key]["key"])
        return None  # a field of the pod, which is not known yet


def _items(document: object) -> Iterator[Object]:
    """The objects of a document: one, those of a List, or none."""
    if document is None:
        return
    if not isinstance(document, dict) or "kind" not in document:
        raise ValueError("it is no manifest: every document needs a kind")
    if document["kind"] == "List":
        for item in document.get("items") or []:
            yield from _items(item)
    elif document["kind"] == "Kustomization":
        raise ValueError("a kustomization has to be built first: kubectl kustomize FOLDER")
    else:
        metadata = document.get("metadata") or {}
        if not isinstance(metadata, dict):
            raise ValueError(f"the metadata of a {document['kind']} is not as Kubernetes wants it")
        yield {**document, "metadata": metadata}


def _containers(item: Object) -> Iterator[Object]:
    """Of a pod, or of what makes pods."""
    spec = item.get("spec") or {}
    spec = (spec.get("jobTemplate") or {}).get("spec") or spec  # of a CronJob
    pod = (spec.get("template") or {}).get("spec") or spec
    for kind in ("initContainers", "containers"):
        yield from pod.get(kind) or []


def _place(item: Object) -> Place:
    return item["kind"], item["metadata"].get("namespace"), item["metadata"].get("name", "")


def _named(item: Object) -> str:
    kind, namespace, name = _place(item)
    return f"{kind} {namespace}/{name}" if namespace else f"{kind} {name}"


def _data(item: Object) -> dict[str, Given]:
    where = f"{_named(item)}: "
    data = {name: str(value or "") for name, value in (item.get("data") or {}).items()}
    if item["kind"] == "Secret":
        plain = {name: str(value or "") for name, value in (item.get("stringData") or {}).items()}
        data = {name: _decoded(value) for name, value in data.items()} | plain
    return {name: Given(value, where) for name, value in data.items()}


def _decoded(text: str) -> str:
    try:
        return base64.b64decode(text, validate=True).decode("utf-8", "replace")
    except binascii.Error:
        raise ValueError("the data of a Secret is no base64") from None
