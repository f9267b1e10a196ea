"""rosbridge: `python3 -m server.rosbridge`, the ROS node `rosbridge_websocket`."""

import asyncio
import logging
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from laser_bot_battle import alive
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import ROSBRIDGE_NODE
from laser_bot_battle.settings import read_or_exit
from server.node import Node, parse_arguments
from server.rosbridge.bridge import Bridge
from server.rosbridge.settings import VARIABLES, Settings
from server.rosbridge.websocket import WebSocketServer

_log = logging.getLogger(__name__)

# A command passes through two threads here. Python hands over between busy threads every 5 ms unless told otherwise,
# which alone would be half of what a command may take from key to coil.
SWITCH_INTERVAL = 0.0005  # s
# rospy's sending threads need a moment for the last neutral commands.
FLUSH = 0.1  # s


def main() -> int:
    """The program; returns its exit code."""
    program = "python3 -m server.rosbridge"
    parse_arguments(program, "WebSocket server between browsers and ROS (rosbridge v2 protocol).", *VARIABLES)
    settings = read_or_exit(program, Settings.from_env)
    configure_logging(settings.node.log_level)
    sys.setswitchinterval(SWITCH_INTERVAL)
    node = Node(ROSBRIDGE_NODE, settings.node)
    return node.run(lambda listener: _serve(node, settings, listener))


@contextmanager
def _serve(node: Node, settings: Settings, listener: socket.socket) -> Iterator[None]:
    thread = node.start_thread("rosbridge", lambda: asyncio.run(_talk(node, settings, listener)))
    try:
        yield
    finally:
        thread.join()


async def _talk(node: Node, settings: Settings, listener: socket.socket) -> None:
    bridge = Bridge(ROSBRIDGE_NODE, settings.operator_token)
    async with WebSocketServer(bridge, listener):
        _log.info("listening on %s port %d", settings.node.bind, settings.node.port)
        while not node.ending.is_set():
            alive.touch()
            await asyncio.to_thread(node.ending.wait, alive.PERIOD)
        bridge.stop()
        await asyncio.sleep(FLUSH)


if __name__ == "__main__":
    sys.exit(main())
