"""cards/inventory: a master's card runs what a master of the fleet runs, and knows no address of its own beforehand."""

import json
import subprocess
from typing import Any

import yaml

from tests.support.programs import ROOT

ROLES = ROOT / "ansible/roles"
SERVICES = yaml.safe_load((ROLES / "master/vars/main.yml").read_text())["master_services"]


def environments() -> dict[str, Any]:
    """By service: its variables on a master's card."""
    files = [f"@{ROLES}/{each}/main.yml" for each in ("fleet/vars", "master/defaults", "master/vars")]
    wanted = "{{ dict(master_services | map(attribute='name') | zip(master_services | map(attribute='env'))) }}"
    told = {"master_token": {"stat": {"mtime": 1}}, "master_token_kept": {}, "master_journal_groups": []}
    told |= {"fleet_log_format": "text", "fleet_arena": "laser-bot-master", "ansible_connection": "local"}
    run = subprocess.run(
        [
            *(ROOT / ".venv/bin/ansible", "card", "--inventory", ROOT / "cards/inventory/master.yml", "--one-line"),
            *("--module-name=ansible.builtin.debug", "--args=var=wanted"),
            *(f"--extra-vars={each}" for each in [*files, json.dumps({**told, "wanted": wanted})]),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    found: dict[str, Any] = json.loads(run.stdout.partition("=>")[2])["wanted"]
    return found


def test_a_masters_card_finds_its_address_out_by_itself() -> None:
    found = environments()
    assert found.keys() == {service["name"] for service in SERVICES}
    assert not [name for name, variables in found.items() if variables.keys() & {"ROS_IP", "ROS_HOSTNAME"}]
    uris = {variables["ROS_MASTER_URI"] for variables in found.values() if "ROS_MASTER_URI" in variables}
    assert uris == {"http://localhost:11311"}
    assert found["laserbot-announcer"]["LASERBOT_ARENA"] == "laser-bot-master"
