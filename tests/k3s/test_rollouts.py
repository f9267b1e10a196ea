"""k3s/rollouts.py: how long k3s.yml waits follows from the battles' limit and the number of pods."""

import json
import subprocess
import sys
from pathlib import Path

import yaml

from tests.k3s.conftest import Customize
from tests.support.manifests import Manifests
from tests.support.programs import ROOT


def run(*words: str, given: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "k3s/rollouts.py"), *words]
    return subprocess.run(command, input=given, capture_output=True, text=True, check=False)


def seconds(manifests: Manifests, robots: int = 0) -> dict[tuple[str, str], int]:
    """By namespace and name; a pod has 90 s to become ready."""
    done = run("90", str(robots), given=yaml.safe_dump_all(manifests.objects))
    assert done.returncode == 0, done.stderr
    return {(each["namespace"], each["name"]): each["seconds"] for each in json.loads(done.stdout)}


def test_robots_wait_in_turn_for_a_battle_of_the_limit_that_is_set(customize: Customize) -> None:
    longer = {
        "name": "settings",
        "namespace": "laserbot",
        "behavior": "merge",
        "literals": ["LASERBOT_BATTLE_LIMIT=600"],
    }
    lan = seconds(customize("lan", configMapGenerator=[longer]), robots=5)
    assert lan == {("laserbot", "master"): 690, ("laserbot", "robot"): 5 * 690}
    sim = seconds(customize("sim", configMapGenerator=[longer], replicas=[{"name": "robot", "count": 4}]))
    assert sim["laserbot", "robot"] == 4 * sim["laserbot", "master"] == 4 * 690


def test_nothing_waits_longer_than_kubernetes_lets_it_and_each_arena_has_its_own_limit(tmp_path: Path) -> None:
    for name, limit in (("red", 86400), ("blue", 60)):
        (tmp_path / f"{name}.yaml").write_text(
            f"namespace: {name}\nhost: {name}.arena.example\nrules: {{LASERBOT_BATTLE_LIMIT: {limit}}}\n"
        )
    subprocess.run([sys.executable, ROOT / "k3s/arenas.py", tmp_path], check=True)
    found = seconds(Manifests(tmp_path / "made"))
    assert found["red", "master"] == 90 + 3600
    assert found["blue", "master"] == 90 + 60


def test_a_workload_without_a_namespace_is_in_the_one_that_kubectl_takes() -> None:
    own = {"kind": "Deployment", "metadata": {"name": "own"}, "spec": {"template": {"spec": {}}}}
    (told,) = json.loads(run("90", "0", given=yaml.safe_dump(own)).stdout)
    assert (told["namespace"], told["name"]) == ("default", "own")


def test_what_cannot_be_used_is_told_in_one_line() -> None:
    for words, given in ((("90",), ""), (("90", "2"), "kind: {"), (("90", "2"), "kind: Deployment")):
        done = run(*words, given=given)
        assert done.returncode == 2
        assert done.stderr.startswith("k3s/rollouts.py: needs START, ROBOTS and manifests at its input: ")
        assert len(done.stderr.splitlines()) == 1
