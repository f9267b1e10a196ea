"""The entrance as a program: it hears of arenas, says that it lives, goes on without them, and ends when told."""

import json
import signal
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
import requests

from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program

STATE = {"game": 0, "available_robots": 2, "users": [], "queue": [], "tournament": 0}


class Arena(BaseHTTPRequestHandler):
    """All that the entrance wants of a master."""

    def do_GET(self) -> None:
        body = json.dumps(STATE).encode() if self.path == "/watch.json" else b""
        self.send_response(200 if body else 404)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - http.server's name
        """Nobody reads it."""


class Server(ThreadingHTTPServer):
    daemon_threads = False  # its end is that of its answers, too


@pytest.fixture
def arena() -> Iterator[Server]:
    with Server(("127.0.0.1", 0), Arena) as server:
        serving = threading.Thread(target=server.serve_forever)
        serving.start()
        yield server
        server.shutdown()
        serving.join()


def test_it_tells_which_arenas_answer_and_ends_in_order(arena: Server, tmp_path: Path) -> None:
    port, alive = free_port(), tmp_path / "alive"
    environment = {
        "LASERBOT_BIND": "127.0.0.1",
        "LASERBOT_ENTRANCE_PORT": str(port),
        "LASERBOT_ARENAS": f"red=:{arena.server_port} blue=:{free_port()}",
        "LASERBOT_DOMAIN": "*",
        "LASERBOT_ALIVE_FILE": str(alive),
        "LASERBOT_DATA": str(tmp_path),
    }
    program = Program.python("server.entrance", env=environment)
    try:
        program.wait_for("the entrance to 2 arenas is at")

        def states() -> dict[str, str]:
            told = requests.get(f"http://127.0.0.1:{port}/arenas.json", timeout=LATEST).json()
            return {one["name"]: one["state"] for one in told["arenas"]}

        until(lambda: states() == {"red": "stopped", "blue": "away"}, 20, "the arena that answers is heard")
        program.wait_for(" is away: ")
        until(alive.exists, 20, "a sign of life")
    finally:
        assert program.stop(signal.SIGTERM) == 0, program.output
    assert "Traceback" not in program.output


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        ({"LASERBOT_ARENAS": "red"}, "LASERBOT_ARENAS=red: 'red' is not name=:port"),
        ({"LASERBOT_DOMAIN": "http://x"}, "LASERBOT_DOMAIN=http://x: must be a domain"),
    ],
)
def test_a_wrong_setting_is_told_in_one_line(variables: dict[str, str], said: str) -> None:
    program = Program.python("server.entrance", env=variables)
    until(lambda: not program.running, 20, "it ends by itself")
    assert program.stop() == 2
    assert said in program.output
    assert len(program.output.splitlines()) == 1
