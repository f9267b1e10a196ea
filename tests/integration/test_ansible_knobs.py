"""Knobs of the fleet: some are refused before anything is done, some are the rules of the battle."""

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from laser_bot_battle.settings import Variable
from server.game.rules import DECLARED, Rules
from server.web.settings import Settings
from tests.support.local_play import play_role, recap
from tests.support.programs import ROOT

GOOD = 'fleet_control_networks: ["192.0.2.1/32"]\nfleet_registry_password: long enough for it\n'


@pytest.mark.parametrize(
    ("tasks", "knob", "words"),
    [
        ("facts", "fleet_registry_password: too short", "of at least 12 characters"),
        ("facts", "fleet_control_networks: []", "fleet_control_networks"),
        ("facts", "fleet_operator_token: fifteen letters", "at least 16 characters"),
        ("operator_token", "fleet_operator_token: 123456789012345", "at least 16 characters"),
        ("images", "fleet_images_archive: build/images.tar", "must be an absolute path"),
    ],
)
def test_a_wrong_knob_is_refused(tasks: str, knob: str, words: str, tmp_path: Path) -> None:
    run = play_role("fleet", tasks, GOOD + knob, tmp_path)
    assert run.returncode != 0
    assert words in run.stdout
    assert all(row["changed"] == 0 for row in recap(run.stdout).values())


@pytest.mark.parametrize("more", ["", "fleet_operator_token: sixteen letters!"])
def test_good_ones_are_not(more: str, tmp_path: Path) -> None:
    assert play_role("fleet", "facts", GOOD + more, tmp_path).returncode == 0


def rules(**knobs: object) -> Rules:
    """Those of a server that has what the role sets by these knobs."""
    role = ROOT / "ansible/roles/master"
    variables = [f"@{role}/defaults/main.yml", f"@{role}/vars/main.yml", json.dumps(knobs)]
    run = subprocess.run(
        [
            *(ROOT / ".venv/bin/ansible", "localhost", "--inventory=localhost,", "--connection=local", "--one-line"),
            *("--module-name=ansible.builtin.debug", "--args=var=master_rules"),
            *(f"--extra-vars={each}" for each in variables),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return Settings.from_env(json.loads(run.stdout.partition("=>")[2])["master_rules"]).rules


def other(rule: Variable[Any]) -> Any:
    """A value of this rule that is not its default."""
    if rule.is_flag:
        return not rule.default
    if rule.words:
        return next(word for word in rule.words if word != rule.default)
    return 2 if rule.default != 2 else 3


def test_the_rules_of_the_battle_reach_the_server() -> None:
    assert rules() == Rules()
    changed = {name: other(variable) for name, variable in DECLARED.items()}
    assert rules(**{f"master_{rule}": value for rule, value in changed.items()}) == Rules(**changed)
