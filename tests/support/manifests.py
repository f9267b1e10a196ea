"""The manifests of k3s/ as a cluster gets them, and what a kubelet makes of them."""

import re
import subprocess
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from tests.support.programs import ROOT

OVERLAYS = ("lan", "sim", "arenas")
WORKLOADS = {"Deployment", "StatefulSet", "DaemonSet"}
SECRET = "0123abcd"  # what every Secret holds: none is applied with the manifests
REFERENCE = re.compile(r"\$\(([^()]+)\)")

Object = dict[str, Any]


class Manifests:
    """What `kubectl apply -k` sends to the cluster, in that order."""

    def __init__(self, folder: Path) -> None:
        result = subprocess.run([ROOT / "ci/kubectl", "kustomize", folder], capture_output=True, text=True, check=False)
        assert result.returncode == 0, f"{folder}: {result.stderr}"
        # the loader in C; the other one takes longer than kubectl
        self.objects: list[Object] = list(yaml.load_all(result.stdout, Loader=yaml.CSafeLoader))

    def of(self, *kinds: str) -> list[Object]:
        return [item for item in self.objects if item["kind"] in kinds]

    @property
    def namespaces(self) -> list[str]:
        return [item["metadata"]["name"] for item in self.of("Namespace")]

    def within(self, namespace: str) -> "Manifests":
        """Only what is in this namespace."""
        part = object.__new__(Manifests)
        part.objects = [item for item in self.objects if item["metadata"].get("namespace") == namespace]
        return part

    def one(self, kind: str, name: str) -> Object:
        (item,) = [item for item in self.of(kind) if item["metadata"]["name"] == name]
        return item

    def config(self, name: str) -> Object:
        """A ConfigMap, whose name is followed by a checksum."""
        (item,) = [item for item in self.of("ConfigMap") if item["metadata"]["name"].rpartition("-")[0] == name]
        return item

    @property
    def workloads(self) -> list[Object]:
        return self.of(*WORKLOADS)

    @property
    def containers(self) -> Iterator[tuple[Object, Object]]:
        """Each container with its pod's spec."""
        for workload in self.workloads:
            pod = workload["spec"]["template"]["spec"]
            for container in (*pod.get("initContainers", []), *pod["containers"]):
                yield pod, container


@cache
def overlay(name: str) -> Manifests:
    """One of ours, also with components: `lan+front`."""
    base, *components = name.split("+")
    if not components:
        return Manifests(ROOT / "k3s/overlays" / base)
    with TemporaryDirectory() as folder:
        return customized(Path(folder), base, *components)


def customized(folder: Path, base: str, *components: str, **fields: object) -> Manifests:
    """An operator's own kustomization in `folder`: its fields, over an overlay and with components of ours."""
    # kustomize takes relative paths only
    up = Path(*[".."] * (len(folder.parts) - 1)) / ROOT.relative_to("/") / "k3s"
    content = {
        "resources": [str(up / "overlays" / base)],
        "components": [str(up / "components" / name) for name in components],
        **fields,
    }
    (folder / "kustomization.yaml").write_text(yaml.safe_dump(content))
    return Manifests(folder)


def service_variables(services: list[Object], addresses: Mapping[str, str]) -> dict[str, str]:
    """What a kubelet tells every pod of a namespace about its Services (not about headless ones).

    `addresses` are the Services' cluster IPs by name.
    """
    found = {}
    for service in services:
        if service["spec"].get("clusterIP") == "None":
            continue
        name = service["metadata"]["name"]
        prefix, address = name.upper().replace("-", "_"), addresses[name]
        ports = service["spec"]["ports"]
        found[f"{prefix}_SERVICE_HOST"] = address
        found[f"{prefix}_SERVICE_PORT"] = str(ports[0]["port"])
        found[f"{prefix}_PORT"] = f"tcp://{address}:{ports[0]['port']}"
        for port in ports:
            number = str(port["port"])
            found[f"{prefix}_SERVICE_PORT_{port['name'].upper().replace('-', '_')}"] = number
            link = f"{prefix}_PORT_{number}_TCP"
            found |= {link: f"tcp://{address}:{number}", f"{link}_PROTO": "tcp"}
            found |= {f"{link}_PORT": number, f"{link}_ADDR": address}
    return found


def expand(text: str, known: Mapping[str, str]) -> str:
    """Replace $(NAME); an unknown one is left as it is."""
    return REFERENCE.sub(lambda match: known.get(match[1], match[0]), text)


class Kubelet:
    """Environment and command of the containers of one pod.

    `manifests` are those of the pod's namespace, `fields` the downward API's (metadata.name, status.podIP, ...),
    `addresses` the Services' by name; a Service without address does not exist yet.
    """

    def __init__(
        self, manifests: Manifests, pod: Object, fields: Mapping[str, str], addresses: Mapping[str, str]
    ) -> None:
        self._manifests, self._fields = manifests, fields
        self._config_maps = {item["metadata"]["name"] for item in manifests.of("ConfigMap")}
        services = [item for item in manifests.of("Service") if item["metadata"]["name"] in addresses]
        self._links = service_variables(services, addresses) if pod.get("enableServiceLinks", True) else {}

    def environment(self, container: Object) -> dict[str, str]:
        """All that the manifest and the kubelet set; KeyError for what is not there."""
        found: dict[str, str] = {}
        for source in container.get("envFrom", []):
            found |= self._manifests.one("ConfigMap", source["configMapRef"]["name"]).get("data", {})
        for variable in container.get("env", []):
            value = self._value(variable, found)
            if value is not None:
                found[variable["name"]] = value
        return self._links | found

    def _value(self, variable: Object, found: dict[str, str]) -> str | None:
        if "valueFrom" not in variable:
            return expand(variable.get("value", ""), {**self._links, **found})
        source = variable["valueFrom"]
        if "fieldRef" in source:
            return self._fields[source["fieldRef"]["fieldPath"]]
        if "configMapKeyRef" in source:
            reference = source["configMapKeyRef"]
            if reference.get("optional") and reference["name"] not in self._config_maps:
                return None
            return str(self._manifests.one("ConfigMap", reference["name"])["data"][reference["key"]])
        return None if source["secretKeyRef"].get("optional") else SECRET

    def command(self, container: Object) -> list[str]:
        environment = self.environment(container)
        return [expand(word, environment) for word in (*container["command"], *container.get("args", []))]
