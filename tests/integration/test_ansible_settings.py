"""The playbooks say what is wrong with the inventory's settings before they change anything."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.support.local_play import play_role, recap
from tests.support.programs import ROOT

FLEET = (
    "fleet_master_address: 192.0.2.1\nfleet_arena: hall\nfleet_log_format: text\n"
    "fleet_ros_port: 11311\nfleet_camera_port: 8090\n"
)


@pytest.mark.parametrize(
    ("role", "knobs", "words"),
    [
        (
            "master",
            "master_hit_damage: lots\nmaster_teams: 7\nmaster_practice: true\nmaster_overhead_height: high\n",
            [
                "LASERBOT_HIT_DAMAGE=lots: must be a whole number from 1 to 100",
                "LASERBOT_OVERHEAD_HEIGHT=high: must be a number from 0.5 to 20",
                "LASERBOT_TEAMS=7: must be 0, 2, 3 or 4",
            ],
        ),
        ("robot", "robot_led: 28\n", ["LASERBOT_LED=28: must be a GPIO from 0 to 27, or none"]),
    ],
)
def test_all_that_is_wrong_is_told_at_once(role: str, knobs: str, words: list[str], tmp_path: Path) -> None:
    run = play_role(role, "settings", FLEET + knobs, tmp_path)
    assert run.returncode != 0
    for line in words:
        assert line in run.stdout
    assert all(row["changed"] == 0 for row in recap(run.stdout).values())


@pytest.mark.parametrize(
    ("floor", "words"),
    [
        ("{folder}/hall.json", "LASERBOT_FLOOR={folder}/hall.json: starts: must have one place at least"),
        ("hall.json", "absolute path of a file on this machine, not hall.json."),
    ],
)
def test_a_floor_that_no_program_could_read_is_told(floor: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "hall.json").write_text('{"width": 2, "height": 2}')
    knob = f"master_floor: {floor.format(folder=tmp_path)}\n"
    run = play_role("master", "settings", FLEET + knob, tmp_path, "laser_bot_master")
    assert run.returncode != 0
    assert words.format(folder=tmp_path) in run.stdout
    assert all(row["changed"] == 0 for row in recap(run.stdout).values())


@pytest.mark.parametrize(
    ("role", "knob"), [("master", ""), ("master", f"master_floor: {ROOT}/floors/hall.json\n"), ("robot", "")]
)
def test_what_the_roles_themselves_set_is_right(role: str, knob: str, tmp_path: Path) -> None:
    run = play_role(role, "settings", FLEET + knob, tmp_path)
    assert run.returncode == 0, run.stdout + run.stderr


def tasks(playbook: str) -> list[dict[str, Any]]:
    plays = yaml.safe_load((ROOT / "ansible" / playbook).read_text())
    return [task for play in plays for task in play.get("tasks", [])]


@pytest.mark.parametrize(("playbook", "change"), [("deploy.yml", "Prepare the host"), ("update.yml", "Run the master")])
def test_a_playbook_asks_before_it_changes_a_host(playbook: str, change: str) -> None:
    names = [task["name"] for task in tasks(playbook)]
    assert names.index("The master's settings can be used") < names.index(change)
    asked = [task["ansible.builtin.import_role"] for task in tasks(playbook) if "settings can be used" in task["name"]]
    assert asked == [{"name": role, "tasks_from": "settings.yml"} for role in ("master", "robot")]


def test_k3s_is_given_only_manifests_that_were_checked() -> None:
    commands = [task.get("ansible.builtin.command", {}) for task in tasks("k3s.yml")]
    stdin = "{{ k3s_manifests.stdout }}"
    given = [command["argv"] for command in commands if command.get("stdin") == stdin]
    assert given[0][1:] == ["-m", "laser_bot_battle.check", "-"]
    assert ["apply" in words for words in given[1:]] == [False, True, False]
