"""rosbridge: `python3 -m server.rosbridge`, the ROS nodes `rosbridge_websocket` and `rosapi`."""

import asyncio
import logging
import socket
import sys
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager

import uvloop

from laser_bot_battle import alive, priority
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import ROSAPI_NODE, ROSBRIDGE_NODE
from laser_bot_battle.settings import read_or_exit
from server.node import Node, read_arguments
from server.rosapi.node import start_rosapi
from server.rosbridge.bridge import Bridge
from server.rosbridge.clock import clock_of
from server.rosbridge.conversion import Types
from server.rosbridge.gate import Gate
from server.rosbridge.handshake import OwnPages, own_names
from server.rosbridge.settings import OPTIONS, VARIABLES, Settings
from server.rosbridge.websocket.server import WebSocketServer
from server.tcpros.node import Node as RosNode

_log = logging.getLogger(__name__)

# The last neutral commands need a moment to get out.
FLUSH = 0.1  # s


def main() -> int:
    """The program; returns its exit code."""
    program = "python3 -m server.rosbridge"
    description = "WebSocket server between browsers and ROS (rosbridge v2 protocol), with rosapi."
    environment = read_arguments(program, description, *VARIABLES, options=OPTIONS)
    settings = read_or_exit(program, Settings.from_env, environment)
    configure_logging(settings.node.log_level)
    priority.take(settings.priority)
    for argument in without_effect(sys.argv[1:]):
        _log.warning("%s has no effect: nothing is remapped here, and settings are options (--help)", argument)
    node = Node(ROSBRIDGE_NODE, settings.node)
    return node.run(lambda listener: _serve(node, settings, listener))


def without_effect(arguments: Sequence[str]) -> list[str]:
    """The ROS arguments, but for what roslaunch adds when it knows the node by its own name."""
    return [
        argument
        for argument in arguments
        if ":=" in argument and argument != f"__name:={ROSBRIDGE_NODE}" and not argument.startswith("__log:=")
    ]


@contextmanager
def _serve(node: Node, settings: Settings, listener: socket.socket) -> Iterator[None]:
    def run() -> None:
        with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
            runner.run(_talk(node, settings, listener))

    thread = node.start_thread("rosbridge", run)
    try:
        yield
    finally:
        thread.join()


@asynccontextmanager
async def _ros_node(node: Node, name: str) -> AsyncIterator[RosNode]:
    ros_node = RosNode(name, node.settings.master_uri)
    ros_node.on_shutdown = lambda reason: node.fail(f"ROS has shut {name} down ({reason})")
    await ros_node.start()
    try:
        yield ros_node
    finally:
        await ros_node.close()


async def _talk(node: Node, settings: Settings, listener: socket.socket) -> None:
    types = Types()
    async with _ros_node(node, ROSBRIDGE_NODE) as ros_node, _ros_node(node, ROSAPI_NODE) as rosapi_node:
        clock = await clock_of(ros_node, types)
        await start_rosapi(rosapi_node, types, clock, settings.globs)
        bridge = Bridge(ros_node, types, clock, Gate(settings.operator_token, settings.globs), settings.is_open)
        pages = OwnPages(settings.web_port, settings.origins, own_names())
        async with WebSocketServer(bridge, listener, pages.identity_of) as server:
            bridge.touch = server.touch
            _log.info("listening on %s port %d", settings.node.bind, settings.node.port)
            if settings.is_open:
                _log.warning("open: everybody who gets to this port may do everything, and drive every robot")
            while not node.ending.is_set():
                alive.touch()
                await asyncio.to_thread(node.ending.wait, alive.PERIOD)
            bridge.stop()
            await asyncio.sleep(FLUSH)


if __name__ == "__main__":
    sys.exit(main())
