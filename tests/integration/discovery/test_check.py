"""Where check.yml finds a master whose address is not in the inventory."""

import json
import sys
from pathlib import Path

from tests.integration.discovery.master import announced
from tests.support.lan import Lan, Machine, needs_root
from tests.support.programs import ROOT

pytestmark = needs_root

CODE = "import sys; from fleet import *; print(Fleet.read(Path(sys.argv[1]), Path('.')).web)"


def asked(machine: Machine, folder: Path, address: str = "", **env: str) -> str:
    """Which web server the checks would ask."""
    master = {"group": "master", "address": address, "user": "pi", "ssh": "", "arena": "hall"}
    hosts = folder / "hosts.json"
    hosts.write_text(json.dumps({"laser_bot_master": master}))
    path = f"{ROOT / 'laser_bot_battle/src'}:{ROOT / 'ansible/checks'}"
    program = machine.program(sys.executable, "-c", CODE, str(hosts), env={"PYTHONPATH": path, **env})
    assert program.exit_code(30) == 0, program.output
    return program.output.strip()


def test_it_is_where_the_fleets_arena_announces_itself(lan: Lan, tmp_path: Path) -> None:
    """No ROS master answers there: a firewall keeps the control machine from it."""
    programs = [
        announced(lan.machine(), name, address) for name, address in (("attic", "10.9.0.8"), ("Hall", "10.9.0.9"))
    ]
    assert asked(lan.machine(), tmp_path) == "http://10.9.0.9:5000"
    for program in programs:
        program.kill()


def test_what_is_given_goes_before_it(lan: Lan, tmp_path: Path) -> None:
    machine = lan.machine()
    program = announced(lan.machine(), "hall", "10.9.0.9")
    assert asked(machine, tmp_path, address="10.9.0.7") == "http://10.9.0.7:5000"
    assert asked(machine, tmp_path, LASERBOT_MASTER="10.9.0.6") == "http://10.9.0.6:5000"
    program.kill()


def test_without_any_it_is_asked_for_by_name(lan: Lan, tmp_path: Path) -> None:
    assert asked(lan.machine(), tmp_path) == "http://laser_bot_master.local:5000"
