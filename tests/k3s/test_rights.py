"""What a container may do: nothing, except where hardware needs it."""

import pytest

from tests.k3s.conftest import Customize
from tests.support.manifests import Kubelet, Manifests, Object, overlay
from tests.support.program_settings import ProgramSettings

ENFORCE = "pod-security.kubernetes.io/enforce"
NO_RIGHTS = {
    "allowPrivilegeEscalation": False,
    "readOnlyRootFilesystem": True,
    "capabilities": {"drop": ["ALL"]},
}


def level(manifests: Manifests) -> set[str]:
    """Of Kubernetes' Pod Security Standards, what the namespaces enforce."""
    return {item["metadata"]["labels"][ENFORCE] for item in manifests.of("Namespace")}


def is_restricted(pod: Object) -> bool:
    """By the standard `restricted`, as far as its rules say something about these pods."""
    rights = pod["securityContext"]
    return (
        rights["runAsNonRoot"] is True
        and rights["runAsUser"] != 0
        and rights.get("seccompProfile") == {"type": "RuntimeDefault"}
        and not any(pod.get(name) for name in ("hostNetwork", "hostPID", "hostIPC"))
        and all({"emptyDir", "persistentVolumeClaim", "secret"} & set(volume) for volume in pod["volumes"])
        and all(container["securityContext"] == NO_RIGHTS for container in pod["containers"])
    )


@pytest.mark.parametrize("name", ["sim", "arenas", "sim+front+monitoring"])
def test_without_hardware_every_pod_is_restricted_and_the_cluster_enforces_it(name: str) -> None:
    assert level(overlay(name)) == {"restricted"}
    for pod, _ in overlay(name).containers:
        assert is_restricted(pod)


@pytest.mark.parametrize("name", ["lan", "lan+front+monitoring"])
def test_on_a_lan_the_master_has_its_hosts_network_and_nothing_else(name: str) -> None:
    assert level(overlay(name)) == {"privileged"}
    pod = overlay(name).one("Deployment", "master")["spec"]["template"]["spec"]
    assert pod.pop("hostNetwork") is True
    try:
        assert is_restricted(pod)
    finally:
        pod["hostNetwork"] = True


def test_on_a_lan_the_robots_privilege_is_its_devices_only() -> None:
    pod = overlay("lan").one("DaemonSet", "robot")["spec"]["template"]["spec"]
    (robot,) = pod["containers"]
    assert robot["securityContext"] == {"privileged": True, "readOnlyRootFilesystem": True}
    assert pod["securityContext"]["runAsNonRoot"] is True
    assert pod["securityContext"]["runAsUser"] != 0
    (dev,) = [volume for volume in pod["volumes"] if "hostPath" in volume]
    assert dev["hostPath"]["path"] == "/dev"
    (mount,) = [mount for mount in robot["volumeMounts"] if mount["name"] == dev["name"]]
    assert mount["readOnly"] is True
    (serial,) = [item["value"] for item in robot["env"] if item["name"] == "LASERBOT_SERIAL"]
    assert all(path.startswith(f"{mount['mountPath']}/") for path in serial.split())


def test_with_a_device_plugin_a_robot_is_not_privileged(customize: Customize) -> None:
    pod = customize("lan", "device-plugin").one("DaemonSet", "robot")["spec"]["template"]["spec"]
    assert pod.pop("hostNetwork") is True
    assert is_restricted(pod)
    (robot,) = pod["containers"]
    assert {"squat.ai/laserbot"} == set(robot["resources"]["limits"]) - {"cpu", "memory"}


def test_a_camera_is_a_container_with_the_robots_rights(customize: Customize) -> None:
    manifests = customize("lan", "camera", namespace="laserbot")
    pod = manifests.one("DaemonSet", "robot")["spec"]["template"]["spec"]
    robot, camera = sorted(pod["containers"], key=lambda container: container["name"] == "camera")
    assert camera["securityContext"] == robot["securityContext"]
    assert 44 in pod["securityContext"]["supplementalGroups"]
    fields = {"spec.nodeName": "raspberrypi1", "status.hostIP": "192.0.2.7"}
    kubelet = Kubelet(manifests, pod, fields, {"master": "10.43.0.1"})
    read = {each["name"]: ProgramSettings(kubelet.command(each), kubelet.environment(each)) for each in (robot, camera)}
    seen, told = read["camera"].settings, read["robot"].settings
    assert seen is not None
    assert told is not None
    assert (told.camera, told.camera_port) == (seen.device, seen.port)
    assert {seen.port} == {port["containerPort"] for port in camera["ports"]}


def test_no_pod_gets_a_token_of_the_cluster(manifests: Manifests) -> None:
    accounts = {}
    for account in manifests.of("ServiceAccount"):
        accounts[account["metadata"]["namespace"], account["metadata"]["name"]] = account
    for workload in manifests.workloads:
        pod = workload["spec"]["template"]["spec"]
        account = accounts[workload["metadata"]["namespace"], pod["serviceAccountName"]]
        assert pod["automountServiceAccountToken"] is False
        assert account["automountServiceAccountToken"] is False


@pytest.mark.parametrize("kept", [("lan",), ("sim", "kept-data")])
def test_what_the_web_server_keeps_outlives_its_pod(customize: Customize, kept: tuple[str, ...]) -> None:
    manifests = customize(*kept)
    master = manifests.one("Deployment", "master")
    pod = master["spec"]["template"]["spec"]
    claim = manifests.one("PersistentVolumeClaim", "data")
    assert claim["metadata"]["namespace"] == master["metadata"]["namespace"]
    (data,) = [volume for volume in pod["volumes"] if volume["name"] == "data"]
    assert data == {"name": "data", "persistentVolumeClaim": {"claimName": claim["metadata"]["name"]}}
    (web,) = [container for container in pod["containers"] if container["name"] == "web"]
    assert {"name": "data", "mountPath": "/var/lib/laserbot"} in web["volumeMounts"]
    assert pod["securityContext"]["fsGroup"] == pod["securityContext"]["runAsUser"], "it may write there"
    # the next pod starts when this one has ended
    assert master["spec"]["strategy"] == {"type": "Recreate"}


def stays(pod: Object) -> bool:
    """Whether the pod is never moved away from a node that the control plane does not reach."""
    forever = {
        item["key"]
        for item in pod.get("tolerations", [])
        if item["effect"] == "NoExecute" and "tolerationSeconds" not in item
    }
    return forever == {"node.kubernetes.io/unreachable", "node.kubernetes.io/not-ready"}


def test_updates_never_run_two_masters_and_change_one_robot_at_a_time(manifests: Manifests) -> None:
    for workload in manifests.workloads:
        spec = workload["spec"]
        match workload["kind"]:
            case "Deployment":
                assert spec["replicas"] == 1
                assert spec["strategy"] == {"type": "Recreate"}
                if workload["metadata"]["name"] in {"master", "arena"}:
                    assert stays(spec["template"]["spec"]), "a lost node would bring a second one"
            case "DaemonSet":
                probe = spec["template"]["spec"]["containers"][0]["readinessProbe"]
                assert probe["periodSeconds"] * probe["failureThreshold"] >= 180, "the master's own update takes less"
                assert spec["updateStrategy"] == {"type": "RollingUpdate", "rollingUpdate": {"maxUnavailable": 1}}


def test_on_a_lan_pods_go_to_the_nodes_with_their_label() -> None:
    roles = {
        workload["metadata"]["name"]: workload["spec"]["template"]["spec"]["nodeSelector"]
        for workload in overlay("lan").workloads
    }
    assert roles == {"master": {"laserbot/role": "master"}, "robot": {"laserbot/role": "robot"}}
