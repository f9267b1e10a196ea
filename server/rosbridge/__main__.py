"""rosbridge: `python3 -m server.rosbridge`, the ROS nodes `rosbridge_websocket` and `rosapi`."""

import asyncio
import logging
import sys

from laser_bot_battle import priority  # isort: split

from laser_bot_battle.listening import Listener
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import ROSAPI_NODE, ROSBRIDGE_NODE
from laser_bot_battle.settings import read_or_exit
from laser_bot_battle.watched import Owner, in_loop, watched
from server.access.handshake import OwnPages, own_names
from server.messages.types import Types
from server.program.event_loop import live, ros_node, warn_of_arguments, work_in_loop
from server.program.program import Program, read_arguments
from server.rosapi.node import start_rosapi
from server.rosbridge.bridge import Bridge
from server.rosbridge.gate import Gate
from server.rosbridge.settings import OPTIONS, VARIABLES, Settings
from server.websocket.server import WebSocketServer
from tcpros.clock import clock_of

_log = logging.getLogger(__name__)

# The last neutral commands need a moment to get out.
FLUSH = 0.1  # s


def main() -> int:
    """The program; returns its exit code."""
    command = "python3 -m server.rosbridge"
    description = "WebSocket server between browsers and ROS (rosbridge v2 protocol), with rosapi."
    environment = read_arguments(command, description, *VARIABLES, options=OPTIONS)
    settings = read_or_exit(command, Settings.from_env, environment)
    configure_logging(settings.program.log_level)
    priority.take(settings.priority)
    warn_of_arguments(ROSBRIDGE_NODE)
    program = Program(ROSBRIDGE_NODE, settings.program)
    return program.run(lambda listener: work_in_loop(program, "rosbridge", lambda: _talk(program, settings, listener)))


async def _talk(program: Program, settings: Settings, listener: Listener) -> None:
    types = Types()
    async with ros_node(program, ROSBRIDGE_NODE) as own_node, ros_node(program, ROSAPI_NODE) as rosapi_node:
        clock = await clock_of(own_node)
        bridge = Bridge(own_node, types, clock, Gate(settings.operator_token, settings.globs), settings.is_open)
        await start_rosapi(rosapi_node, types, clock, settings.globs, bridge.outside)
        pages = OwnPages(settings.web_port, settings.origins, own_names())
        async with WebSocketServer(bridge, listener, pages.identity_of, proxies=settings.proxies):
            _log.info("listening on %s port %d", settings.program.bind, settings.program.port)
            if settings.is_open:
                _log.warning("open: everybody who gets to this port may do everything, and drive every robot")
            with watched("rosbridge", settings.program.metrics, in_loop(Owner(bridge.metrics, bridge.missing))):
                await live(program)
                bridge.stop()  # first of all: whoever looked at its figures may take a moment to be sent away
            await asyncio.sleep(FLUSH)


if __name__ == "__main__":
    sys.exit(main())
