"""The floor of a fleet: the inventory's file at first, then what the operator's desk saves in it."""

import os
import re
from pathlib import Path

from tests.support.local_play import play_tasks, recap

# what the role does with the floor, and what it then sets for the programs that read it
TASKS = """
- ansible.builtin.include_role: {name: master, tasks_from: floor.yml, public: true}
- ansible.builtin.debug: {var: master_floor_setting.LASERBOT_FLOOR}
"""


def deploy(folder: Path) -> tuple[int, Path]:
    """How many steps have changed something, and the file that the master's programs are to read."""
    (folder / "tasks.yml").write_text(TASKS)
    knobs = f"master_data: {folder}/data\nmaster_floor: {folder}/hall.json\nfleet_container_user: {os.getuid()}\n"
    run = play_tasks(folder / "tasks.yml", knobs, folder, "laser_bot_master")
    told = re.search(r'"master_floor_setting.LASERBOT_FLOOR": "(.*)"', run.stdout)
    assert told, run.stdout + run.stderr
    return recap(run.stdout)["laser_bot_master"]["changed"], Path(told[1])


def test_a_deployment_keeps_what_the_desk_has_saved_until_the_inventory_has_another_floor(tmp_path: Path) -> None:
    inventory = tmp_path / "hall.json"
    inventory.write_text('{"width": 4}\n')
    changed, first = deploy(tmp_path)
    assert (changed, first.read_text()) == (1, '{"width": 4}\n')
    first.write_text("of the desk")
    assert deploy(tmp_path) == (0, first)
    assert first.read_text() == "of the desk"
    inventory.write_text('{"width": 5}\n')
    changed, second = deploy(tmp_path)
    assert (changed, second.read_text()) == (1, '{"width": 5}\n')
    assert second != first, "what runs would go on with the old one"
