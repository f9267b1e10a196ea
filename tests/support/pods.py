"""Pods in a Docker Engine, as a kubelet would run them: what there is of a cluster where there is no cluster.

A pod is a container that only holds the network, and the containers of the manifest in that network, with the user,
rights, volumes, environment, command and limits that the manifest says. There is no name service at all. A Service's
address is one of its pod's, and of the next pod in its place: every Service's port is its pod's port (tests/k3s).
"""

import http.client
import json
import os
import re
import shutil
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from ipaddress import ip_network
from itertools import islice
from pathlib import Path
from typing import Any, Self

from docker.models import containers
from docker.types import IPAMConfig, IPAMPool

from tests.support.containers import engine, execute, remove
from tests.support.manifests import Kubelet, Manifests, Object
from tests.support.polling import until
from tests.support.ports import free_port

SERVICES = "198.18.0.0/24"  # of the addresses for tests of networks: no LAN has them


def cores(quantity: str) -> float:
    """Of Kubernetes, such as 2 or 300m."""
    return int(quantity[:-1]) / 1000 if quantity.endswith("m") else float(quantity)


class Pod:
    """One pod of a workload.

    `folder` has what the pod finds of its host, and what Secrets have: secrets/NAME/KEY. `publish` are pod ports by the
    ports of this machine's localhost, `devices` are this machine's by the paths at which the containers see them.
    """

    def __init__(
        self,
        workload: Object,
        name: str,
        folder: Path,
        publish: Mapping[int, int] | None = None,
        devices: Mapping[str, str] | None = None,
    ) -> None:
        self.name = name
        self.spec: Object = workload["spec"]["template"]["spec"]
        folder.mkdir(exist_ok=True)
        self._folder, self._devices = folder, devices or {}
        resolver = folder / "resolv.conf"
        resolver.write_text("nameserver 192.0.2.1\n")  # of the addresses for documentation: nobody answers
        self._resolver = f"{resolver}:/etc/resolv.conf:ro"
        self._sandbox = engine().containers.run(
            self.spec["containers"][0]["image"],
            ["sleep", "infinity"],
            detach=True,
            hostname=name,
            volumes=[self._resolver],
            ports={f"{inside}/tcp": ("127.0.0.1", local) for local, inside in (publish or {}).items()},
            **self._rights({"securityContext": {}}),
        )
        self._sandbox.reload()
        (own,) = self._sandbox.attrs["NetworkSettings"]["Networks"].values()
        self.address = str(own["IPAddress"])
        self.containers: dict[str, containers.Container] = {}

    def join(self, network: str, address: str | None) -> None:
        """Be in a further network, too."""
        engine().networks.get(network).connect(self._sandbox, ipv4_address=address)

    def start(self, manifests: Manifests, addresses: Mapping[str, str]) -> None:
        """Start all containers; `manifests` are the namespace's, `addresses` the Services' by name."""
        for container in self.spec["containers"]:
            self.start_container(container["name"], manifests, addresses)

    def start_container(self, name: str, manifests: Manifests, addresses: Mapping[str, str]) -> None:
        """Start one container, or again with what its environment is now."""
        if name in self.containers:
            remove([self.containers[name]])
        container = self.of(name)
        fields = {"metadata.name": self.name, "status.podIP": self.address, "status.hostIP": self.address}
        kubelet = Kubelet(manifests, self.spec, fields | {"spec.nodeName": self.name}, addresses)
        limits = container["resources"]["limits"]
        command = kubelet.command(container)
        volumes, tmpfs = self._mounts(container)
        self.containers[name] = engine().containers.run(
            container["image"],
            command[1:],
            entrypoint=command[0],
            detach=True,
            network_mode=f"container:{self._sandbox.id}",
            volumes=[*volumes, self._resolver],
            tmpfs=tmpfs,
            mem_limit=limits["memory"].removesuffix("i").lower(),
            nano_cpus=round(cores(limits["cpu"]) * 1e9),
            environment=kubelet.environment(container),
            **self._rights(container),
        )

    def of(self, name: str) -> Object:
        (container,) = [each for each in self.spec["containers"] if each["name"] == name]
        return dict(container)

    def _rights(self, container: Object) -> dict[str, Any]:
        pod, own = self.spec["securityContext"], container["securityContext"]
        return {
            "user": f"{pod['runAsUser']}:{pod['runAsGroup']}",
            "group_add": [pod["fsGroup"], *pod.get("supplementalGroups", [])],
            "privileged": own.get("privileged", False),
            "read_only": own.get("readOnlyRootFilesystem", False),
            "cap_drop": own.get("capabilities", {}).get("drop", []),
            "security_opt": ["no-new-privileges"] if own.get("allowPrivilegeEscalation") is False else [],
        }

    def _mounts(self, container: Object) -> tuple[list[str], dict[str, str]]:
        """The volumes, and the options of the emptyDirs by path. An emptyDir's user may write to it: runc before 1.2
        gives it the mode of the image's folder."""
        volumes, rights = {volume["name"]: volume for volume in self.spec["volumes"]}, self.spec["securityContext"]
        bound, empty = [f"{device}:{path}" for path, device in self._devices.items()], {}
        for mount in container["volumeMounts"]:
            volume = volumes[mount["name"]]
            if "emptyDir" in volume:
                size = re.sub("i$", "", volume["emptyDir"]["sizeLimit"]).lower()
                options = f"uid={rights['runAsUser']},gid={rights['fsGroup']},mode=2777,size={size}"
                empty[mount["mountPath"]] = options
            else:
                read_only = ":ro" if mount.get("readOnly") else ""
                bound.append(f"{self._host_path(volume)}:{mount['mountPath']}{read_only}")
        return bound, empty

    def _host_path(self, volume: Object) -> Path:
        """Instead of the host's own folder, or of a claim's or a Secret's, one of this test's."""
        claim, secret = volume.get("persistentVolumeClaim"), volume.get("secret")
        if claim:
            name = claim["claimName"]
        else:
            name = secret["secretName"] if secret else volume["hostPath"]["path"].lstrip("/")
        path = self._folder / name
        path.mkdir(parents=True, exist_ok=True)
        for item in (secret or {}).get("items", []):
            given = self._folder / "secrets" / name / item["key"]
            if given.exists():
                shutil.copyfile(given, path / item["path"])
        if claim:  # the cluster gives it to the pod's group
            os.chown(path, -1, self.spec["securityContext"]["fsGroup"])
            path.chmod(0o2775)
        return path

    def passes(self, name: str, probe: str) -> bool:
        """What the kubelet finds when it asks this probe of the container."""
        container = self.of(name)
        how = container[probe]
        if "exec" in how:
            return bool(self.containers[name].exec_run(how["exec"]["command"]).exit_code == 0)
        place = how.get("httpGet") or how["tcpSocket"]
        (port,) = [each["containerPort"] for each in container["ports"] if each["name"] == place["port"]]
        connection = http.client.HTTPConnection(self.address, port, timeout=how["timeoutSeconds"])
        try:
            connection.connect()
            if "tcpSocket" in how:
                return True
            connection.request("GET", place["path"])
            return 200 <= connection.getresponse().status < 400
        except OSError:
            return False
        finally:
            connection.close()

    def wait_until_ready(self, seconds: float = 60.0) -> None:
        for name in self.containers:
            if "readinessProbe" not in self.of(name):  # ready as soon as it runs
                continue
            try:
                until(partial(self.passes, name, "readinessProbe"), seconds, f"{self.name}/{name} is ready")
            except AssertionError as error:
                raise AssertionError(f"{error}\n{self.logs(name)}") from None

    def state(self, name: str) -> Object:
        self.containers[name].reload()
        return dict(self.containers[name].attrs["State"])

    def has_ended(self, name: str) -> bool:
        return not self.state(name)["Running"]

    def logs(self, name: str) -> str:
        output: bytes = self.containers[name].logs()
        return output.decode(errors="replace")

    def read(self, url: str) -> Any:
        """The JSON that a program gives only to those in the pod; its image needs no Python for that."""
        ask = f"from urllib.request import urlopen; print(urlopen('{url}', timeout=10).read().decode())"
        version = self.spec["containers"][0]["image"].partition(":")[2]
        output: bytes = engine().containers.run(
            f"webserver:{version}", ["python3", "-c", ask], network_mode=f"container:{self._sandbox.id}", remove=True
        )
        return json.loads(output)

    def exec(self, name: str, *command: str) -> str:
        return execute(self.containers[name], *command)

    def kill(self, name: str) -> None:
        self.containers[name].kill()

    def stop(self) -> None:
        """As a kubelet ends a pod: by each image's own signal, and after the time of grace by force."""
        with ThreadPoolExecutor() as together:
            grace = self.spec["terminationGracePeriodSeconds"]
            list(together.map(lambda container: container.stop(timeout=grace), self.containers.values()))

    def remove(self) -> None:
        remove([*self.containers.values(), self._sandbox])


class ClusterBattle:
    """All pods of a namespace, a place to play at (tests.support.player)."""

    def __init__(self, manifests: Manifests, folder: Path) -> None:
        self.manifests = manifests
        self.node_ports = {
            port["targetPort"]: port["nodePort"]
            for service in manifests.of("Service")
            for port in service["spec"].get("ports", [])
            if "nodePort" in port
        }
        self.web = f"http://127.0.0.1:{self.node_ports['web']}"
        self.rosbridge_port, self.arena_port = self.node_ports["rosbridge"], self.node_ports["view"]
        self.bridge = f"ws://127.0.0.1:{self.rosbridge_port}"
        self.view = f"ws://127.0.0.1:{self.arena_port}/view"
        self.pods: dict[str, Pod] = {}
        self.folder = folder
        # the workloads that Services lead to, whose pods' names are their own
        self._targets = {
            item["metadata"]["name"]: item["spec"]["selector"]["app.kubernetes.io/name"]
            for item in manifests.of("Service")
            if item["spec"].get("clusterIP") != "None"
        }
        hosts = islice(ip_network(SERVICES).hosts(), 100, None)  # the engine gives the first ones to the other pods
        self._address_of = {target: str(next(hosts)) for target in sorted(set(self._targets.values()))}

    def __enter__(self) -> Self:
        self._network = engine().networks.create(
            f"laserbot-services-{os.getpid()}", internal=True, ipam=IPAMConfig(pool_configs=[IPAMPool(subnet=SERVICES)])
        )
        try:
            for workload in self.manifests.workloads:
                name = workload["metadata"]["name"]
                for number in range(workload["spec"]["replicas"]):
                    self._create(workload, f"{name}-{number}" if workload["kind"] == "StatefulSet" else name)
            for pod in self.pods.values():
                pod.start(self.manifests, self.addresses)
        except AssertionError:
            self.__exit__()
            raise
        return self

    def _create(self, workload: Object, name: str) -> None:
        ports = {
            port["name"]: port["containerPort"]
            for container in workload["spec"]["template"]["spec"]["containers"]
            for port in container.get("ports", [])
        }
        publish = {self.node_ports[each]: ports[each] for each in ports if each in self.node_ports}
        self.pods[name] = Pod(workload, name, self.folder / name, publish)
        self.pods[name].join(str(self._network.id), self._address_of.get(workload["metadata"]["name"]))

    def __exit__(self, *_: object) -> None:
        for pod in self.pods.values():
            pod.remove()
        self._network.remove()

    @property
    def addresses(self) -> dict[str, str]:
        """The Services' addresses by name."""
        return {service: self._address_of[target] for service, target in self._targets.items()}

    def roll_out(self, manifests: Manifests, name: str) -> None:
        """Replace the pod of a Deployment with the strategy Recreate, as when `manifests` are applied."""
        self.manifests = manifests
        old = self.pods.pop(name)
        old.stop()
        old.remove()
        # the lowest address that is free would be the old pod's again, while in a cluster the new one has another
        taken = Pod(manifests.one("Deployment", name), f"not-{name}", self.folder / "not")
        try:
            self._create(manifests.one("Deployment", name), name)
        finally:
            taken.remove()
        self.pods[name].start(manifests, self.addresses)

    def restart_what_ended(self) -> list[str]:
        """As a kubelet does, but at once; the names of the containers."""
        ended = [(pod, name) for pod in self.pods.values() for name in pod.containers if pod.has_ended(name)]
        for pod, name in ended:
            pod.start_container(name, self.manifests, self.addresses)
        return [f"{pod.name}/{name}" for pod, name in ended]

    def wait_until_ready(self, seconds: float = 60.0) -> None:
        for pod in self.pods.values():
            pod.wait_until_ready(seconds)


def merged(name: str, *literals: str) -> Object:
    """An operator's own values for a ConfigMap of ours, for a kustomization."""
    return {"name": name, "namespace": "laserbot", "behavior": "merge", "literals": list(literals)}


def free_node_ports() -> Object:
    """For a kustomization: ports of this machine for those of the nodes."""
    return merged("node-ports", *[f"{name}={free_port()}" for name in ("web", "rosbridge", "relay", "view")])
