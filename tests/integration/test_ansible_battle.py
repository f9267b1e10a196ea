"""roles/fleet/tasks/battle.yml: which hosts a playbook may take out of service now."""

import json
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from tests.support.ports import free_port
from tests.support.programs import ROOT

STOPPED, COUNTDOWN, PLAYING = 0, 1, 2
INVENTORY = """
all: {vars: {ansible_connection: local, ansible_python_interpreter: "{{ ansible_playbook_python }}"}}
master: {hosts: {laser_bot_master: {}}}
robots: {hosts: {raspberrypi1: {}, raspberrypi2: {}}}
"""
PLAY = """
- hosts: all
  gather_facts: false
  tasks:
    - ansible.builtin.include_role: {name: fleet, tasks_from: battle.yml}
      vars: {fleet_tries: 1}
"""


@contextmanager
def server(game: int) -> Iterator[int]:
    """The web server's answer when robot 1 has a player who is ready, and robot 2 one who is not; yields its port."""
    users = [{"ready": 1, "life": 100, "name": "Ann", "robot": 1}, {"ready": 0, "life": 100, "name": "Bob", "robot": 2}]

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.send_response(200)
            self.end_headers()
            self.wfile.write(json.dumps({"status": "OK", "game": game, "users": json.dumps(users)}).encode())

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as listening:
        thread = threading.Thread(target=listening.serve_forever)
        thread.start()
        try:
            yield listening.server_port
        finally:
            listening.shutdown()
            thread.join()


def refused(port: int, folder: Path) -> set[str]:
    """The hosts that are left alone."""
    (folder / "hosts.yml").write_text(INVENTORY)
    (folder / "play.yml").write_text(PLAY)
    run = subprocess.run(
        [
            ROOT / ".venv/bin/ansible-playbook",
            f"--inventory={folder}/hosts.yml",
            f"--extra-vars=fleet_web_port={port}",
            folder / "play.yml",
        ],
        env={
            "PATH": "/usr/bin:/bin",
            "ANSIBLE_CONFIG": str(ROOT / "ansible/ansible.cfg"),
            "ANSIBLE_STRATEGY_PLUGINS": str(ROOT / "ansible/strategy_plugins"),
            "ANSIBLE_HOME": str(folder / "home"),
            "ANSIBLE_LOCAL_TEMP": str(folder / "home/tmp"),
            "ANSIBLE_NOCOLOR": "1",
        },
        capture_output=True,
        text=True,
        check=False,
    )
    rows = [line.split() for line in run.stdout.partition("PLAY RECAP")[2].splitlines() if "failed=" in line]
    assert len(rows) == 3, run.stdout + run.stderr
    return {row[0] for row in rows if "failed=0" not in row}


@pytest.mark.parametrize(
    ("game", "hosts"),
    [
        (STOPPED, set()),
        (COUNTDOWN, {"laser_bot_master", "raspberrypi1", "raspberrypi2"}),  # Bob may still become ready
        (PLAYING, {"laser_bot_master", "raspberrypi1"}),
    ],
)
def test_who_is_in_a_battle_is_left_alone(game: int, hosts: set[str], tmp_path: Path) -> None:
    with server(game) as port:
        assert refused(port, tmp_path) == hosts


def test_a_fleet_whose_server_does_not_answer_has_no_battle(tmp_path: Path) -> None:
    assert refused(free_port(), tmp_path) == set()
