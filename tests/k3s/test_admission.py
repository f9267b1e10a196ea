"""k3s/admission: the cluster itself refuses a workload whose settings are impossible, by the same declarations as the
programs. No API server is here: its expressions are evaluated by another implementation of their language."""

import json
from collections.abc import Mapping
from typing import Any

import celpy
import kubernetes_validate
import pytest
import yaml
from celpy import celtypes
from celpy.adapter import json_to_cel

from laser_bot_battle.admission import CHECKED, pattern, shown
from laser_bot_battle.variables import LASERBOT
from tests.k3s.conftest import Customize
from tests.k3s.test_overlays import VERSIONS
from tests.support.manifests import Manifests, Object
from tests.support.programs import ROOT

FOLDER = ROOT / "k3s/admission"
POLICY, BINDING = yaml.safe_load_all((FOLDER / "policy.yaml").read_text())
# what Kubernetes adds to the language
FUNCTIONS: dict[str, Any] = {
    "trim": lambda text: celtypes.StringType(text.strip()),
    "join": lambda parts, between: celtypes.StringType(between.join(parts)),
}


def evaluated(expression: str, **given: Any) -> Any:
    environment = celpy.Environment()
    program = environment.program(environment.compile(expression), functions=FUNCTIONS)
    return program.evaluate(given)


def refusal(workload: Object, config: Object) -> str:
    """What the cluster says to a workload beside a ConfigMap; "" if it takes it."""
    known: dict[str, Any] = {"object": json_to_cel(workload), "params": json_to_cel(config)}
    variables = celtypes.MapType()
    for variable in POLICY["spec"]["variables"]:
        value = evaluated(variable["expression"], **known, variables=variables)
        variables[celtypes.StringType(variable["name"])] = value
    (validation,) = POLICY["spec"]["validations"]
    if evaluated(validation["expression"], **known, variables=variables):
        return ""
    return str(evaluated(validation["messageExpression"], **known, variables=variables))


def web(**more: object) -> Object:
    """A workload that reads the ConfigMap `settings-1`."""
    first = {"name": "web", "envFrom": [{"secretRef": {"name": "x"}}, {"configMapRef": {"name": "settings-1"}}], **more}
    return {"spec": {"template": {"spec": {"containers": [{"name": "other"}, first]}}}}


def settings(data: Mapping[str, str], name: str = "settings-1") -> Object:
    return {"metadata": {"name": name}, "data": dict(data)}


def test_the_file_is_what_the_declarations_make() -> None:
    assert (FOLDER / "policy.yaml").read_text() == shown()


def test_every_mistake_in_a_config_map_is_named() -> None:
    wrong = {
        "LASERBOT_HIT_DAMAGE": "lots",
        "LASERBOT_COUNTDOWN": "0.01",
        "LASERBOT_TEAMS": "1",
        "LASERBOT_LIGHT": "red",
        "LASERBOT_ROSTER": "raspberrypi1",
        "LASERBOT_BATLE_LIMIT": "60",
    }
    assert refusal(web(), settings(wrong)).split("; ") == [
        "LASERBOT_HIT_DAMAGE=lots: must be a whole number from 1 to 100",
        "LASERBOT_COUNTDOWN=0.01: must be a number from 0.1 to 3600",
        "LASERBOT_TEAMS=1: must be 0, 2, 3 or 4",
        "LASERBOT_LIGHT=red: must be one of plain, coded",
        "LASERBOT_ROSTER=raspberrypi1: must be name=ID with an ID from 0 to 127",
        "LASERBOT_BATLE_LIMIT: there is no such setting",
    ]


def test_values_in_the_workload_itself_count_too() -> None:
    literal = {"name": "LASERBOT_WEB_PORT", "value": "65536"}
    later = {"name": "LASERBOT_RELAY_PORT", "value": "$(MASTER_SERVICE_PORT_RELAY)"}
    field = {"name": "ROS_IP", "valueFrom": {"fieldRef": {"fieldPath": "status.podIP"}}}
    told = refusal(web(env=[literal, later, field]), settings({}))
    assert told == "LASERBOT_WEB_PORT=65536: must be a whole number from 1 to 65535"


def test_a_config_map_by_its_keys_counts_and_one_that_is_not_named_does_not() -> None:
    wrong = settings({"LASERBOT_TEAMS": "7"}, "other-1")
    assert refusal(web(), wrong) == ""
    key = {"name": "LASERBOT_TEAMS", "valueFrom": {"configMapKeyRef": {"name": "other-1", "key": "LASERBOT_TEAMS"}}}
    assert refusal(web(env=[key]), wrong) == "LASERBOT_TEAMS=7: must be 0, 2, 3 or 4"


@pytest.mark.parametrize(
    "data", [{}, {"LASERBOT_COUNTDOWN": "0.5", "LASERBOT_LIGHT": "CODED", "LASERBOT_SEATS": " 3 "}]
)
def test_good_ones_are_taken(data: Mapping[str, str]) -> None:
    good = {"LASERBOT_ROSTER": "a=1, b=2", "LASERBOT_ORIGINS": "https://a.example http://b:81", "LASERBOT_TEAMS": ""}
    assert refusal(web(), settings({**good, **data})) == ""
    assert refusal(web(), {"metadata": {"name": "settings-1"}}) == ""


@pytest.mark.parametrize("variable", CHECKED, ids=lambda variable: str(variable.name))
def test_what_a_program_takes_the_policy_takes(variable: Any) -> None:
    """The lowest, the highest and each word; and one of them too much is refused."""
    values = [*variable.words]
    if variable.lowest is not None:
        values = [f"{variable.lowest:g}", f"{variable.highest:g}"] if not variable.pattern else ["2"]
    for value in values:
        variable.parse(value)
        assert refusal(web(), settings({variable.name: value})) == ""
    if variable.highest is not None:
        assert variable.name in refusal(web(), settings({variable.name: f"{variable.highest + 1:g}"}))


def test_only_what_takes_any_text_or_is_too_much_for_a_pattern_is_left_to_the_programs() -> None:
    left = {variable.name for variable in LASERBOT if not pattern(variable)}
    assert {"LASERBOT_HIT_DAMAGE", "LASERBOT_ROSTER", "LASERBOT_ARENA_PORT", "LASERBOT_LOG_LEVEL"}.isdisjoint(left)


# each overlay, and each component at least once
HOST_NAME = {"name": "host-name", "literals": ["host=arena.example", "class=traefik", "issuer=letsencrypt"]}
REGISTRY = {"name": "registry", "literals": ["address=registry.example"]}
ENTRANCE_HOST = {"name": "arenas", "behavior": "merge", "literals": ["host=arena.example"]}  # as of arenas with hosts
COMBINATIONS = [
    ("lan", ["camera", "device-plugin", "front", "monitoring"]),
    ("lan", ["proxy", "registry"]),
    ("sim", ["announcer", "kept-data", "backups", "ingress", "host-name", "metrics"]),
    ("sim", ["gateway", "certificate", "prometheus-operator"]),
    ("sim", ["node-ports", "bots", "overhead"]),
    ("arenas", ["entrance", "entrance-host", "leaderboard", "leaderboard-backups"]),
]


def test_all_overlays_and_components_are_among_these() -> None:
    covered = {base for base, _ in COMBINATIONS} | {part for _, parts in COMBINATIONS for part in parts}
    there = {path.name for kind in ("overlays", "components") for path in (ROOT / "k3s" / kind).iterdir()}
    assert covered == there - {"network-policies"}, "which is part of sim"


@pytest.mark.parametrize(("base", "components"), COMBINATIONS)
def test_the_policy_sees_all_that_our_programs_read_and_takes_it(
    customize: Customize, base: str, components: list[str]
) -> None:
    given = [each for each in (HOST_NAME, REGISTRY) if {each["name"], "certificate"} & {*components}]
    given += [ENTRANCE_HOST] if base == "arenas" else []
    manifests = customize(base, *components, configMapGenerator=given)
    labels = BINDING["spec"]["paramRef"]["selector"]["matchLabels"].items()
    for workload in manifests.workloads:
        names = read_by(workload)
        assert labels <= workload["metadata"]["labels"].items(), workload["metadata"]["name"]
        for config in manifests.within(workload["metadata"]["namespace"]).of("ConfigMap"):
            if config["metadata"]["name"] in names:
                assert labels <= config["metadata"].get("labels", {}).items(), config["metadata"]["name"]
                assert refusal(workload, config) == ""


def read_by(workload: Object) -> set[str]:
    """The names of the ConfigMaps that its containers read."""
    containers = workload["spec"]["template"]["spec"]["containers"]
    sources = [each for container in containers for each in container.get("envFrom", [])]
    keys = [each.get("valueFrom", {}) for container in containers for each in container.get("env", [])]
    whole = {each["configMapRef"]["name"] for each in sources}
    return whole | {each["configMapKeyRef"]["name"] for each in keys if "configMapKeyRef" in each}


@pytest.mark.parametrize("kubernetes", [VERSIONS[0], VERSIONS[-1]])
def test_it_fits_the_schemas(kubernetes: str) -> None:
    for item in Manifests(FOLDER).objects:
        kubernetes_validate.validate(item, kubernetes, strict=True)
    assert BINDING["spec"]["policyName"] == POLICY["metadata"]["name"]
    assert len(json.dumps(POLICY)) < 100_000
