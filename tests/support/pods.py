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
import subprocess
from collections.abc import Mapping
from functools import partial
from ipaddress import ip_network
from itertools import islice
from pathlib import Path
from typing import Self

from tests.support.containers import docker
from tests.support.manifests import Kubelet, Manifests, Object
from tests.support.polling import until
from tests.support.ports import free_port

SERVICES = "198.18.0.0/24"  # of the addresses for tests of networks: no LAN has them


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
        self._sandbox = docker(
            "run", "--detach", f"--hostname={name}", *self._rights({"securityContext": {}}),
            f"--volume={resolver}:/etc/resolv.conf:ro",
            *[f"--publish=127.0.0.1:{local}:{inside}" for local, inside in (publish or {}).items()],
            self.spec["containers"][0]["image"], "sleep", "infinity",
        ).strip()  # fmt: skip
        self._resolver = resolver
        self.address = docker(
            "inspect", "--format", "{{range .NetworkSettings.Networks}}{{.IPAddress}}{{end}}", self._sandbox
        ).strip()
        self.containers: dict[str, str] = {}

    def join(self, network: str, address: str | None) -> None:
        """Be in a further network, too."""
        docker("network", "connect", *([f"--ip={address}"] if address else []), network, self._sandbox)

    def start(self, manifests: Manifests, addresses: Mapping[str, str]) -> None:
        """Start all containers; `manifests` are the namespace's, `addresses` the Services' by name."""
        for container in self.spec["containers"]:
            self.start_container(container["name"], manifests, addresses)

    def start_container(self, name: str, manifests: Manifests, addresses: Mapping[str, str]) -> None:
        """Start one container, or again with what its environment is now."""
        if name in self.containers:
            docker("rm", "--force", "--volumes", self.containers[name])
        container = self.of(name)
        fields = {"metadata.name": self.name, "status.podIP": self.address, "status.hostIP": self.address}
        kubelet = Kubelet(manifests, self.spec, fields | {"spec.nodeName": self.name}, addresses)
        limits = container["resources"]["limits"]
        command = kubelet.command(container)
        self.containers[name] = docker(
            "run", "--detach", f"--network=container:{self._sandbox}",
            *self._rights(container), *self._mounts(container),
            f"--volume={self._resolver}:/etc/resolv.conf:ro",
            f"--memory={limits['memory'].removesuffix('i').lower()}", f"--cpus={limits['cpu']}",
            *[f"--env={key}={value}" for key, value in kubelet.environment(container).items()],
            f"--entrypoint={command[0]}", container["image"], *command[1:],
        ).strip()  # fmt: skip

    def of(self, name: str) -> Object:
        (container,) = [each for each in self.spec["containers"] if each["name"] == name]
        return dict(container)

    def _rights(self, container: Object) -> list[str]:
        pod, own = self.spec["securityContext"], container["securityContext"]
        groups = [pod["fsGroup"], *pod.get("supplementalGroups", [])]
        flags = [f"--user={pod['runAsUser']}:{pod['runAsGroup']}", *[f"--group-add={group}" for group in groups]]
        flags += ["--privileged"] if own.get("privileged") else []
        flags += ["--read-only"] if own.get("readOnlyRootFilesystem") else []
        flags += [f"--cap-drop={each}" for each in own.get("capabilities", {}).get("drop", [])]
        flags += ["--security-opt=no-new-privileges"] if own.get("allowPrivilegeEscalation") is False else []
        return flags

    def _mounts(self, container: Object) -> list[str]:
        """Who may write to an emptyDir is its user: runc before 1.2 gives it the mode of the image's folder."""
        volumes, rights = {volume["name"]: volume for volume in self.spec["volumes"]}, self.spec["securityContext"]
        flags = []
        for mount in container["volumeMounts"]:
            volume = volumes[mount["name"]]
            if "emptyDir" in volume:
                size = re.sub("i$", "", volume["emptyDir"]["sizeLimit"]).lower()
                options = f"uid={rights['runAsUser']},gid={rights['fsGroup']},mode=2777,size={size}"
                flags.append(f"--tmpfs={mount['mountPath']}:{options}")
            else:
                read_only = ":ro" if mount.get("readOnly") else ""
                flags.append(f"--volume={self._host_path(volume)}:{mount['mountPath']}{read_only}")
        return flags + [f"--volume={device}:{path}" for path, device in self._devices.items()]

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
            words = ["docker", "exec", self.containers[name], *how["exec"]["command"]]
            return subprocess.run(words, capture_output=True, timeout=60, check=False).returncode == 0
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
        return dict(json.loads(docker("inspect", "--format", "{{json .State}}", self.containers[name])))

    def has_ended(self, name: str) -> bool:
        return not self.state(name)["Running"]

    def logs(self, name: str) -> str:
        words = ["docker", "logs", self.containers[name]]
        return subprocess.run(words, capture_output=True, text=True, check=True, errors="replace").stdout + (
            subprocess.run(words, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, check=True).stderr
        )

    def exec(self, name: str, *command: str) -> str:
        return docker("exec", self.containers[name], *command)

    def kill(self, name: str) -> None:
        docker("kill", self.containers[name])

    def stop(self) -> None:
        """As a kubelet ends a pod: by each image's own signal, and after the time of grace by force."""
        docker("stop", f"--time={self.spec['terminationGracePeriodSeconds']}", *self.containers.values())

    def remove(self) -> None:
        docker("rm", "--force", "--volumes", *self.containers.values(), self._sandbox)


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
        name = f"laserbot-services-{os.getpid()}"
        self._network = docker("network", "create", "--internal", f"--subnet={SERVICES}", name).strip()
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
        self.pods[name].join(self._network, self._address_of.get(workload["metadata"]["name"]))

    def __exit__(self, *_: object) -> None:
        for pod in self.pods.values():
            pod.remove()
        docker("network", "rm", self._network)

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
