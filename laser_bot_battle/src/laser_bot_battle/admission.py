"""By which a cluster refuses workloads with impossible settings: k3s/admission/policy.yaml.

    python3 -m laser_bot_battle.admission     prints it

The master's old pod ends before the new one begins, so nothing in the new one could keep the old one running: the
cluster has to refuse the Deployment itself, by what the ConfigMaps hold that it names. Refusing a ConfigMap would not
do: kubectl would go on with the Deployment, whose pod then lacks it. The policy knows numbers, words and names; what
else may be wrong with a value, `laser_bot_battle.check` says.
"""

import json
from typing import Any

import yaml

from laser_bot_battle.settings import Variable
from laser_bot_battle.variables import LASERBOT

# what no setting can be, to hear what it must be
_IMPOSSIBLE = "?"


def pattern(variable: Variable[Any]) -> str:
    """What a value looks like as a whole, "" for any text."""
    if variable.pattern:
        return f"^{variable.pattern}$"
    if variable.is_flag:
        return "^[01]$"
    if variable.words:
        return f"(?i)^({'|'.join(variable.words)})$"
    if variable.lowest is not None:
        return "^[0-9]{1,9}$" if "whole" in allowed(variable) else "^[0-9]{1,9}([.][0-9]{1,9})?$"
    return ""


def allowed(variable: Variable[Any]) -> str:
    """What the variable's own error says: "must be ..."."""
    try:
        variable.parse(_IMPOSSIBLE)
    except ValueError as error:
        return str(error).replace(f"{_IMPOSSIBLE!r} is not", "must be")
    raise AssertionError(f"{variable.name} may be {_IMPOSSIBLE}")


CHECKED = [variable for variable in LASERBOT if pattern(variable)]
RANGES = {
    variable.name: [float(variable.lowest), float(variable.highest)]
    for variable in CHECKED
    if variable.lowest is not None and variable.highest is not None
}

# Kubernetes' CEL (common expression language); `e` is a variable with its name and value
_WRONG = """\
e.name in variables.patterns && e.value.trim() != ''
        && (!e.value.trim().matches(variables.patterns[e.name])
            || e.name in variables.ranges && (double(e.value.trim()) < variables.ranges[e.name][0]
                || double(e.value.trim()) > variables.ranges[e.name][1]))"""

VARIABLES = {
    "patterns": json.dumps({variable.name: pattern(variable) for variable in CHECKED}, indent=2),
    "ranges": json.dumps({name: RANGES[name] for name in RANGES}).replace("], ", "],\n"),
    "allowed": json.dumps({variable.name: allowed(variable) for variable in CHECKED}, indent=2),
    "known": json.dumps([variable.name for variable in LASERBOT], indent=2),
    "sources": """\
object.spec.template.spec.containers.exists(c,
    has(c.envFrom) && c.envFrom.exists(s, has(s.configMapRef) && s.configMapRef.name == params.metadata.name)
    || has(c.env) && c.env.exists(e, has(e.valueFrom) && has(e.valueFrom.configMapKeyRef)
        && e.valueFrom.configMapKeyRef.name == params.metadata.name))
&& has(params.data) ? dyn([params.data.map(k, {'name': k, 'value': params.data[k]})]) : dyn([])""",
    "literals": """\
object.spec.template.spec.containers.map(c,
    has(c.env) ? dyn(c.env.filter(e, has(e.value) && !e.value.contains('$('))) : dyn([]))""",
    "mistakes": f"""\
(variables.sources + variables.literals).map(source,
    source.filter(e, {_WRONG})
        .map(e, e.name + '=' + e.value + ': ' + variables.allowed[e.name])
    + source.filter(e, e.name.startsWith('LASERBOT_') && !(e.name in variables.known))
        .map(e, e.name + ': there is no such setting')
).filter(lines, lines.size() > 0).map(lines, lines.join('; '))""",
}


def policy() -> list[dict[str, Any]]:
    """The ValidatingAdmissionPolicy and its binding."""
    name = "settings.laserbot"
    ours = {"matchLabels": {"app.kubernetes.io/part-of": "laserbot"}}
    workloads = {
        "apiGroups": ["apps"],
        "apiVersions": ["v1"],
        "operations": ["CREATE", "UPDATE"],
        "resources": ["deployments", "statefulsets", "daemonsets"],
        "scope": "*",  # the default; without it, each `kubectl apply` would send the whole list again
    }
    return [
        {
            "apiVersion": "admissionregistration.k8s.io/v1",
            "kind": "ValidatingAdmissionPolicy",
            "metadata": {"name": name},
            "spec": {
                "failurePolicy": "Ignore",  # a fault of this check must not hold up a game
                "paramKind": {"apiVersion": "v1", "kind": "ConfigMap"},
                "matchConstraints": {"objectSelector": ours, "resourceRules": [workloads]},
                "variables": [{"name": key, "expression": text} for key, text in VARIABLES.items()],
                "validations": [
                    {
                        "expression": "variables.mistakes.size() == 0",
                        "messageExpression": "variables.mistakes.join('; ')",
                        "message": "impossible settings: python3 -m laser_bot_battle.check tells which",
                        "reason": "Invalid",
                    }
                ],
            },
        },
        {
            "apiVersion": "admissionregistration.k8s.io/v1",
            "kind": "ValidatingAdmissionPolicyBinding",
            "metadata": {"name": name},
            "spec": {
                "policyName": name,
                # each of the namespace's ConfigMaps in turn
                "paramRef": {"selector": ours, "parameterNotFoundAction": "Allow"},
                "validationActions": ["Deny"],
            },
        },
    ]


class _Dumper(yaml.SafeDumper):
    """Lists and texts of several lines as people write them."""

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
        super().increase_indent(flow, False)


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style="|" if "\n" in text else None)


_Dumper.add_representer(str, _text)


def shown() -> str:
    """The whole file."""
    head = "---\n# Made by `python3 -m laser_bot_battle.admission`, which says what it is for.\n"
    return head + yaml.dump_all(policy(), Dumper=_Dumper, sort_keys=False, width=130)


if __name__ == "__main__":
    print(shown(), end="")
