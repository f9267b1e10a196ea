"""A second `kubectl apply` has nothing to send, and says `unchanged` of each object.

kubectl compares what it applies with what the cluster has, where that adds what is left out and drops what is empty. In
most places it overlooks that. But a list without a key for its items counts as a whole, and what has the patch strategy
`replace` is always sent.
"""

from collections.abc import Iterator
from functools import cache

import pytest
from kubernetes_validate import utils

from tests.k3s.test_overlays import VERSIONS
from tests.support.manifests import Manifests, Object, overlay
from tests.support.programs import ROOT

STRATEGY = "x-kubernetes-patch-strategy"
# of each kind of object in such a list, what the cluster adds to it
ADDED: dict[str, set[str]] = {
    "ConfigMapEnvSource": set(),
    "EnvFromSource": set(),
    "KeyToPath": set(),
    "LabelSelector": set(),
    "NamedRuleWithOperations": {"scope"},
    "NetworkPolicyEgressRule": set(),
    "NetworkPolicyIngressRule": set(),
    "NetworkPolicyPeer": set(),
    "NetworkPolicyPort": {"protocol"},
    "NodeSelectorRequirement": set(),
    "NodeSelectorTerm": set(),
    "PodAffinityTerm": set(),
    "PreferredSchedulingTerm": set(),
    "Toleration": set(),
    "Validation": set(),
    "WeightedPodAffinityTerm": set(),
}


@cache
def definitions() -> dict[str, Object]:
    file = f"kubernetes-json-schema/v{VERSIONS[-1]}-local/_definitions.json"
    found: dict[str, Object] = utils.schema_contents(file, VERSIONS[-1])["$defs"]
    return found


def sent_as_a_whole(value: object, schema: Object, inside: bool = False) -> Iterator[tuple[str, Object]]:
    """Each object in there that counts as a part of a whole, with its kind."""
    strategy = schema.get(STRATEGY, "")
    name = schema.get("$ref", "").rpartition("/")[2]
    schema = definitions()[name] if name else schema
    if isinstance(value, list):
        for each in value:
            yield from sent_as_a_whole(each, schema.get("items", {}), inside or "merge" not in strategy)
    elif isinstance(value, dict):
        if strategy == "replace":
            yield f"{name}, which is always sent", value
        elif inside and name:
            yield name.rpartition(".")[2], value
        for key, each in value.items():
            of_field = schema.get("properties", {}).get(key) or schema.get("additionalProperties") or {}
            yield from sent_as_a_whole(each, of_field, inside)


def schema_of(item: Object) -> Object:
    group, _, version = item["apiVersion"].rpartition("/")
    kind = {"group": group, "kind": item["kind"], "version": version}
    (name,) = [
        name for name, each in definitions().items() if kind in (each.get("x-kubernetes-group-version-kind") or ())
    ]
    return {"$ref": f"#/$defs/{name}"}


@pytest.mark.parametrize(
    "name",
    [
        "lan+camera+device-plugin+front+monitoring+overhead",
        "sim+announcer+bots+kept-data+backups+proxy",
        "arenas+entrance+leaderboard+leaderboard-backups",
        "admission",
    ],
)
def test_nothing_that_the_cluster_adds_or_drops_is_sent_again(name: str) -> None:
    manifests = Manifests(ROOT / "k3s/admission") if name == "admission" else overlay(name)
    for item in manifests.objects:
        for kind, each in sent_as_a_whole(item, schema_of(item)):
            assert kind in ADDED, f"{item['kind']} {item['metadata']['name']}: look up what the cluster adds to {kind}"
            assert ADDED[kind] <= each.keys(), f"{item['kind']} {item['metadata']['name']}: {each}"
    for container in (each for item in manifests.objects for each in containers(item)):
        assert [each["name"] for each in container.get("env", ()) if each.get("value") == ""] == []


def containers(item: Object) -> list[Object]:
    spec = item.get("spec", {})
    spec = spec.get("jobTemplate", {}).get("spec", spec)
    found: list[Object] = spec.get("template", {}).get("spec", {}).get("containers", [])
    return found
