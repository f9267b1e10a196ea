"""What health checks look at: a file whose time a working program renews."""

from pathlib import Path

import pytest

from tests.integration.sim.arena import HOST
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program

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
