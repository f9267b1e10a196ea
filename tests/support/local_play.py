"""Plays that need no host: they run on this machine, over a local connection."""

import subprocess
from pathlib import Path

from tests.support.programs import ROOT

INVENTORY = """
all: {vars: {ansible_connection: local, ansible_python_interpreter: "{{ ansible_playbook_python }}"}}
master: {hosts: {laser_bot_master: {}}}
robots: {hosts: {raspberrypi1: {}, raspberrypi2: {}}}
"""


def play_role(
    role: str, tasks: str, variables: str, folder: Path, limit: str = "all", *flags: str
) -> subprocess.CompletedProcess[str]:
    """Runs a role's file of tasks for a master and two robots. `variables` are YAML, `folder` is first in PATH."""
    task = f"ansible.builtin.include_role: {{name: {role}, tasks_from: {tasks}.yml}}"
    return _play(task, variables, folder, limit, *flags)


def play_tasks(file: Path, variables: str, folder: Path, limit: str = "all") -> subprocess.CompletedProcess[str]:
    """The same with a file of tasks that is no role's."""
    return _play(f"ansible.builtin.include_tasks: {file}", variables, folder, limit)


def _play(task: str, variables: str, folder: Path, limit: str, *flags: str) -> subprocess.CompletedProcess[str]:
    (folder / "hosts.yml").write_text(INVENTORY)
    (folder / "vars.yml").write_text(variables)
    (folder / "play.yml").write_text(f"""
- hosts: all
  gather_facts: false
  tasks:
    - {task}
""")
    return run_playbook(folder / "play.yml", f"@{folder}/vars.yml", folder, limit, *flags)


def run_playbook(
    playbook: Path, variables: str, folder: Path, limit: str, *flags: str
) -> subprocess.CompletedProcess[str]:
    """`variables` as --extra-vars has them; the inventory is hosts.yml in `folder`, which is first in PATH."""
    return subprocess.run(
        [
            ROOT / ".venv/bin/ansible-playbook",
            f"--inventory={folder}/hosts.yml",
            f"--limit={limit}",
            f"--extra-vars={variables}",
            playbook,
            *flags,
        ],
        env={
            "PATH": f"{folder}:/usr/bin:/bin",
            "ANSIBLE_CONFIG": str(ROOT / "ansible/ansible.cfg"),
            "ANSIBLE_HOME": str(folder / "home"),
            "ANSIBLE_LOCAL_TEMP": str(folder / "home/tmp"),
            "ANSIBLE_NOCOLOR": "1",
        },
        capture_output=True,
        text=True,
        check=False,
    )


def recap(output: str) -> dict[str, dict[str, int]]:
    """ok, changed, failed, unreachable ... of each host."""
    lines = output.partition("PLAY RECAP")[2].partition("\n\n")[0].splitlines()[1:]
    rows = (line.split(" : ") for line in lines if " : " in line)
    return {host.strip(): {key: int(n) for key, n in (w.split("=") for w in row.split())} for host, row in rows}
