"""roles/fleet/tasks/battle.yml: which hosts a playbook may take out of service now."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from tests.support.local_play import play_role, recap
from tests.support.ports import free_port

STOPPED, COUNTDOWN, PLAYING = 0, 1, 2


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
    run = play_role("fleet", "battle", f"fleet_web_port: {port}\nfleet_tries: 1\n", folder)
    rows = recap(run.stdout)
    assert len(rows) == 3, run.stdout + run.stderr
    return {host for host, row in rows.items() if row["failed"]}


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
