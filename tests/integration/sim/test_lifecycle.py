"""What health checks look at: a file whose time a working program renews."""

import json
from pathlib import Path

import pytest
from websockets.exceptions import WebSocketException

from tests.integration.sim.arena import HOST
from tests.support.polling import AGAIN, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.sockets import connect

PORTS = ("LASERBOT_WEB_PORT", "LASERBOT_ARENA_PORT", "LASERBOT_ARENA_LINK_PORT")


@pytest.mark.parametrize("module", ["sim.arena", "server.bots"])
def test_a_working_program_renews_its_file(module: str, tmp_path: Path) -> None:
    """That of the bots works without a server, too: it waits."""
    file = tmp_path / "alive"
    env = {"LASERBOT_ALIVE_FILE": str(file), "LASERBOT_MASTER": HOST, "LASERBOT_BIND": HOST}
    program = Program.python(module, env={**env, **{port: str(free_port()) for port in PORTS}})
    try:
        until(file.exists, 15, "the first sign of life")
        first = file.stat().st_mtime_ns
        until(lambda: file.stat().st_mtime_ns > first, 5, "the next one")
    finally:
        assert program.stop() == 0


def test_the_arena_begins_anew_when_its_floor_is_another_one(tmp_path: Path) -> None:
    file = tmp_path / "hall.json"
    file.write_text('{"width": 2, "height": 1, "starts": [[1, 0.5]]}')
    port = free_port()
    env = {"LASERBOT_BIND": HOST, "LASERBOT_ARENA_PORT": str(port), "LASERBOT_ARENA_LINK_PORT": str(free_port())}
    program = Program.python("sim.arena", env={**env, "LASERBOT_FLOOR": str(file)})

    def width() -> float:
        try:
            with connect(f"ws://{HOST}:{port}/view") as view:
                return float(json.loads(view.recv(timeout=AGAIN))["width"])
        except (OSError, WebSocketException):
            return 0.0

    try:
        until(lambda: width() == 2, 15, "the first floor")
        file.write_text('{"width": 3, "height": 1, "starts": [[1, 0.5]]}')
        until(lambda: width() == 3, 15, "the other one")
    finally:
        assert program.stop() == 0
