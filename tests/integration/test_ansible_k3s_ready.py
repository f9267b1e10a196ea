"""ansible/tasks/k3s_ready.yml: k3s.yml waits for what it has applied, and not for robots that are switched off."""

import json
from pathlib import Path

import pytest

from tests.support.local_play import play_tasks, recap
from tests.support.programs import ROOT

# What a DaemonSet's status says: one line of `counts` each time, the last one from then on.
K3S = """#!/bin/sh
echo "$*" >>{folder}/asked
case "$*" in
*" get daemonset "*) head -n 1 {folder}/counts; [ $(wc -l <{folder}/counts) = 1 ] || sed -i 1d {folder}/counts ;;
esac
"""
WORKLOADS = [
    {"namespace": "laserbot", "kind": "Deployment", "name": "master", "seconds": 690},
    {"namespace": "laserbot", "kind": "DaemonSet", "name": "robot", "seconds": 2},
]


def play(folder: Path, counts: str, off: str) -> tuple[list[str], int]:
    """What the cluster was asked for, and how often the play has failed."""
    (folder / "k3s").write_text(K3S.format(folder=folder))
    (folder / "k3s").chmod(0o755)
    (folder / "counts").write_text(f"{counts}\n")
    variables = f"k3s_rollouts: {json.dumps(WORKLOADS)}\nk3s_off: {off}\nk3s_period: 1\n"
    run = play_tasks(ROOT / "ansible/tasks/k3s_ready.yml", variables, folder, "laser_bot_master")
    return (folder / "asked").read_text().splitlines(), recap(run.stdout)["laser_bot_master"]["failed"]


@pytest.mark.slow
def test_each_workload_has_the_time_that_its_battles_may_take(tmp_path: Path) -> None:
    asked, failed = play(tmp_path, "7,7,3,3,3", "[]")
    assert failed == 0
    assert asked[0] == "kubectl --namespace laserbot rollout status deployment/master --timeout=690s"
    assert len(asked) == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("counts", "off"),
    [
        pytest.param("7,6,3,3,3\n7,7,3,,3\n7,7,3,3,3", "[]", id="all are on"),
        pytest.param("7,7,3,1,2\n7,7,3,2,1\n7,7,3,2,2", "[raspberrypi2]", id="one is off"),
    ],
)
def test_it_waits_until_the_robots_that_are_on_have_been_replaced(counts: str, off: str, tmp_path: Path) -> None:
    asked, failed = play(tmp_path, counts, off)
    assert failed == 0
    assert len([line for line in asked if " get daemonset robot " in line]) == 3


@pytest.mark.slow
def test_a_robot_that_is_on_and_not_ready_fails(tmp_path: Path) -> None:
    assert play(tmp_path, "7,7,3,2,2", "[]")[1] == 1
