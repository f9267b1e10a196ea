"""NetworkPolicies as nftables: what a network plugin enforces, for pods that are network namespaces.

As Kubernetes describes them: a pod that no policy selects for a direction is open; otherwise, what any of them allows
passes. Answers pass, and the pod may talk to itself.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from tests.support.manifests import Manifests, Object

NAME = "kubernetes.io/metadata.name"  # a label that Kubernetes gives each namespace
FIELDS = {"podSelector", "policyTypes", "ingress", "egress"}
PEER_FIELDS = {"podSelector", "namespaceSelector", "ipBlock"}


@dataclass(frozen=True)
class Pod:
    """What policies know of a pod."""

    namespace: str
    address: str
    labels: Object = field(default_factory=dict)
    ports: Object = field(default_factory=dict)  # numbers by name


def pod_of(workload: Object, address: str) -> Pod:
    """One of the workload's pods."""
    template = workload["spec"]["template"]
    ports = {
        port["name"]: port["containerPort"]
        for container in template["spec"]["containers"]
        for port in container.get("ports", ())
    }
    return Pod(workload["metadata"]["namespace"], address, template["metadata"]["labels"], ports)


def ruleset(pod: Pod, pods: Sequence[Pod], manifests: Manifests) -> str:
    """The pod's nftables. `pods` are all of the cluster; refused is answered at once."""
    policies = [
        item["spec"]
        for item in manifests.of("NetworkPolicy")
        if item["metadata"]["namespace"] == pod.namespace and _matches(item["spec"]["podSelector"], pod.labels)
    ]
    assert all(policy.keys() <= FIELDS for policy in policies), "what this does not understand"
    lines = ["flush ruleset", "table inet pod {"]
    for chain, kind, rules, peers, address in (
        ("input", "Ingress", "ingress", "from", "ip saddr"),
        ("output", "Egress", "egress", "to", "ip daddr"),
    ):
        chosen = [policy for policy in policies if kind in policy["policyTypes"]]
        lines += [f"chain {chain} {{", f"type filter hook {chain} priority filter"]
        lines += ["ct state established,related accept", f"{'iif' if chain == 'input' else 'oif'} lo accept"]
        for policy in chosen:
            for rule in policy.get(rules, ()):
                lines += _accepting(rule, peers, address, pod, pods)
        lines += ["ct state new reject with icmp port-unreachable"] if chosen else []
        lines.append("}")
    return "\n".join([*lines, "}"])


def _accepting(rule: Object, peers: str, address: str, pod: Pod, pods: Iterable[Pod]) -> Iterator[str]:
    sources = [""]
    if peers in rule:
        sources = [f"{address} {found}" for peer in rule[peers] for found in _addresses(peer, pod.namespace, pods)]
    ports = [""]
    if "ports" in rule:  # a name that the pod has not is no port of it
        assert {each["protocol"] for each in rule["ports"]} == {"TCP"}
        numbers = [pod.ports.get(each["port"], each["port"]) for each in rule["ports"]]
        ports = [f"tcp dport {number}" for number in numbers if isinstance(number, int)]
    for source in sources:
        for port in ports:
            yield f"{source} {port} accept"


def _addresses(peer: Object, namespace: str, pods: Iterable[Pod]) -> Iterator[str]:
    assert peer.keys() <= PEER_FIELDS
    if "ipBlock" in peer:
        yield peer["ipBlock"]["cidr"]
        return
    for pod in pods:
        same = pod.namespace == namespace
        there = _matches(peer["namespaceSelector"], {NAME: pod.namespace}) if "namespaceSelector" in peer else same
        if there and _matches(peer.get("podSelector", {}), pod.labels):
            yield pod.address


def _matches(selector: Object, labels: Object) -> bool:
    assert selector.keys() <= {"matchLabels"}
    return bool(selector.get("matchLabels", {}).items() <= labels.items())
