"""What robots report, from a ROS node of the tests."""

import contextlib
from collections.abc import Iterator

from tests.support.battle import Battle
from tests.support.programs import Program


@contextlib.contextmanager
def node(battle: Battle, *words: str) -> Iterator[None]:
    """A ROS node beside those of the battle's robots: see tests/integration/server/peers.py."""
    ros = {
        "ROS_MASTER_URI": f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOSTNAME": "127.0.0.1",
    }
    program = Program.python("tests.integration.server.peers", *words, env=ros)
    try:
        yield
    finally:
        program.stop()
