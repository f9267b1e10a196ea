"""ansible/README.md says what the roles do."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from fleet import Machine
from server.game.rules import DECLARED
from tests.support.documents import blocks
from tests.support.programs import ROOT

ANSIBLE = ROOT / "ansible"
README = (ANSIBLE / "README.md").read_text()


def test_every_knob_is_in_the_table_and_in_the_example_and_no_other() -> None:
    knobs = {
        knob
        for defaults in ANSIBLE.glob("roles/*/defaults/main.yml")
        for knob in re.findall(r"^(\w+):", defaults.read_text(), re.MULTILINE)
    }
    assert set(re.findall(r"^\| `([a-z]+_\w+)` \|", README, re.MULTILINE)) == knobs
    rules = {f"master_{rule}" for rule in DECLARED}
    example = "".join(file.read_text() for file in (ANSIBLE / "inventory/example/group_vars/all").iterdir())
    assert set(re.findall(r"^(?:# )?((?!ansible_)[a-z]+_\w+):", example, re.MULTILINE)) - rules == knobs


def test_every_playbook_is_in_the_table_and_no_other() -> None:
    assert set(re.findall(r"^\| `(\w+\.yml)` \|", README, re.MULTILINE)) == {
        path.name for path in ANSIBLE.glob("*.yml")
    }


def test_its_steps_make_an_inventory(tmp_path: Path) -> None:
    """The commands of step 4, as they stand there: what comes out is a fleet whose secrets are encrypted."""
    shutil.copytree(ANSIBLE, tmp_path / "ansible")
    (steps,) = [block for block in blocks(README, "sh") if "inventory/example" in block]
    (encrypt,) = re.findall(r"`(ansible-vault encrypt .*?)`", README)
    (tmp_path / "password").write_text("of the vault\n")
    environment = {
        **os.environ,
        "PATH": f"{ROOT / '.venv/bin'}:{os.environ['PATH']}",
        "ANSIBLE_VAULT_PASSWORD_FILE": str(tmp_path / "password"),
    }
    script = f"{steps}\n{encrypt} >/dev/null 2>&1\nansible-inventory -i inventory/mine --list"
    made = subprocess.run(
        ["sh", "-ec", script], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert made.returncode == 0, made.stderr
    known = json.loads(made.stdout[made.stdout.index("{") :])
    assert len(known["master"]["hosts"]) == 1
    assert len(known["robots"]["hosts"]) >= 2
    secrets = known["_meta"]["hostvars"][known["master"]["hosts"][0]]
    assert {"fleet_registry_password", "fleet_operator_token"} <= secrets.keys()
    vault = tmp_path / "ansible/inventory/mine/group_vars/all/vault.yml"
    assert vault.read_text().startswith("$ANSIBLE_VAULT")


def test_no_secret_has_a_default() -> None:
    """Neither in the roles nor in the example: an operator who forgets to choose one is told so."""
    places = [ANSIBLE / "roles/fleet/defaults/main.yml", ANSIBLE / "inventory/example/group_vars/all/vault.example.yml"]
    for place in places:
        values = yaml.safe_load(place.read_text())
        assert (values["fleet_registry_password"], values["fleet_operator_token"]) == ("", ""), place


def test_the_firewall_by_hand_closes_the_ports_of_the_fleets() -> None:
    fleets = (ANSIBLE / "roles/firewall/templates/firewall.nft.j2").read_text()
    (ros_nodes,) = re.findall(r"ros_nodes = '(.*)'", fleets)
    (ros_master,) = re.findall(
        r"^fleet_ros_port: (.*)$", (ANSIBLE / "roles/fleet/vars/main.yml").read_text(), re.MULTILINE
    )
    for document in ("docs/lan.md", "docs/kubernetes-network.md"):
        rules = re.findall(r"^ +iifname .* drop$", (ROOT / document).read_text(), re.MULTILINE)
        assert f"tcp dport {{ {ros_master}, {ros_nodes} }} ip saddr != " in rules[0]


def test_check_yml_looks_at_every_service_of_a_master() -> None:
    variables = yaml.safe_load((ANSIBLE / "roles/master/vars/main.yml").read_text())
    deployed = {service["name"] for part in ("master_services", "master_overhead") for service in variables[part]}
    assert set(Machine("hall", "master", "192.0.2.1", "pi", "", overhead=True).services) == deployed


def test_check_yml_expects_no_service_whose_program_the_release_lacks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The image is a folder here; one that lacks a program of the core is no release."""
    asked: list[str] = []

    def run(machine: Machine, command: str) -> str:
        words = shlex.split(command)
        code = words.index("-c")
        asked.append(" ".join(words[:code]))
        look = [sys.executable, *words[code:]]
        return subprocess.run(look, cwd=tmp_path, capture_output=True, text=True, check=True).stdout

    monkeypatch.setattr(Machine, "run", run)
    for module in ("camera", "store", "front", "announcer"):
        (tmp_path / "server" / module).mkdir(parents=True)
        (tmp_path / "server" / module / "__init__.py").touch()
    master = Machine("hall", "master", "192.0.2.1", "pi", "", overhead=True)
    assert master.left_out == ["laserbot-rosout", "laserbot-bots", "laserbot-overhead"]
    assert sorted(master.running + master.left_out) == sorted(master.services)
    robot = Machine("raspberrypi1", "robots", "192.0.2.2", "pi", "", camera=True)
    assert robot.running == ["laserbot-robot"]
    assert Machine("raspberrypi2", "robots", "192.0.2.3", "pi", "").running == ["laserbot-robot"]
    assert asked == ["docker exec laserbot-rosmaster python3", "docker exec laserbot-robot python3"]


def test_the_core_of_a_master_are_services_of_its() -> None:
    variables = yaml.safe_load((ANSIBLE / "roles/master/vars/main.yml").read_text())
    core = variables["master_core"]
    assert set(core) <= {service["name"] for service in variables["master_services"]}
    (run,) = yaml.safe_load((ANSIBLE / "roles/master/tasks/run.yml").read_text())
    assert run["vars"]["release_core"] == "{{ master_core }}"
