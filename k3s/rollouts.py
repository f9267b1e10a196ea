#!/usr/bin/env python3
"""Tells how long it may take until all pods of manifests have been replaced.

    kubectl kustomize FOLDER | k3s/rollouts.py START ROBOTS

prints JSON: of each workload `namespace`, `kind`, `name` and `seconds`. Each pod may wait for the end of a battle that
has just begun, and robots are replaced one after another. START is how many seconds a pod then has to become ready,
ROBOTS the number of nodes with a robot.
"""

import json
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

try:
    import yaml
except ImportError:
    sys.exit("k3s/rollouts.py: PyYAML is missing: apt-get install python3-yaml")

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "laser_bot_battle/src"))

from laser_bot_battle.manifest_settings import groups
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.variables import BATTLE_LIMIT

WORKLOADS = {"Deployment", "StatefulSet", "DaemonSet"}
GRACE = 30  # s; Kubernetes' own, where a pod does not say

Object = dict[str, Any]


def rollouts(objects: Sequence[Object], start: int, robots: int) -> Iterator[Object]:
    """What is printed. SettingsError."""
    limits: dict[str, float] = {}
    for item in objects:
        if item["kind"] not in WORKLOADS:
            continue
        namespace = item["metadata"].get("namespace", "default")
        if namespace not in limits:
            limits[namespace] = _limit([each for each in objects if each["metadata"].get("namespace") == namespace])
        pod = item["spec"]["template"]["spec"]
        waits = min(limits[namespace], pod.get("terminationGracePeriodSeconds", GRACE))
        yield {
            "namespace": namespace,
            "kind": item["kind"],
            "name": item["metadata"]["name"],
            "seconds": _in_turn(item, robots) * math.ceil(start + waits),
        }


def _in_turn(workload: Object, robots: int) -> int:
    """How many pods are replaced one after another; those of a Deployment end together."""
    pods = {"Deployment": 1, "StatefulSet": int(workload["spec"].get("replicas", 1)), "DaemonSet": robots}
    return max(1, pods[workload["kind"]])


def _limit(objects: Sequence[Object]) -> float:
    """Of the battles in one namespace, in s."""
    read = groups("\n---\n".join(json.dumps(item, default=str) for item in objects))
    texts = [group[BATTLE_LIMIT.name].value for group in read if BATTLE_LIMIT.name in group]
    return max((BATTLE_LIMIT.read({BATTLE_LIMIT.name: text}) for text in texts), default=BATTLE_LIMIT.default)


def main(words: Sequence[str]) -> int:
    """Exit code 0, or 2 for input that cannot be used."""
    try:
        start, robots = map(int, words)
        objects = [item for item in yaml.load_all(sys.stdin.read(), Loader=yaml.CSafeLoader) if item]
        print(json.dumps(list(rollouts(objects, start, robots))))
    except (SettingsError, ValueError, KeyError, TypeError, yaml.YAMLError) as error:
        why = " ".join(str(error).split())
        print(f"k3s/rollouts.py: needs START, ROBOTS and manifests at its input: {why}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
