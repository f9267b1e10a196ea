"""The cameras' relay: `python3 -m server.camera`, the ROS node `camera_relay`."""

import logging
import sys

from laser_bot_battle.listening import Listener
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import RELAY_NODE
from laser_bot_battle.settings import read_or_exit
from laser_bot_battle.watched import Owner, in_loop, watched
from server.access.handshake import OwnPages, own_names
from server.camera.access import CameraAccess
from server.camera.relay import Relay, limits_of
from server.camera.settings import VARIABLES, Settings
from server.program.event_loop import live, ros_node, warn_of_arguments, work_in_loop
from server.program.program import Program, read_arguments
from server.websocket.server import WebSocketServer

_log = logging.getLogger(__name__)


def main() -> int:
    """The program; returns its exit code."""
    command = "python3 -m server.camera"
    description = "The relay of the robots' cameras: one connection to each that somebody looks through."
    settings = read_or_exit(command, Settings.from_env, read_arguments(command, description, *VARIABLES))
    configure_logging(settings.program.log_level)
    warn_of_arguments(RELAY_NODE)
    program = Program(RELAY_NODE, settings.program)
    return program.run(lambda listener: work_in_loop(program, "relay", lambda: _relay(program, settings, listener)))


async def _relay(program: Program, settings: Settings, listener: Listener) -> None:
    pages = OwnPages(settings.web_port, settings.origins, own_names())
    async with ros_node(program, RELAY_NODE) as own_node:
        relay = Relay(own_node, CameraAccess(settings.operator_token), settings.viewers, settings.rate)
        async with WebSocketServer(relay, listener, pages.identity_of, limits_of(settings.viewers), settings.proxies):
            _log.info("listening on %s port %d", settings.program.bind, settings.program.port)
            with watched("relay", settings.program.metrics, in_loop(Owner(relay.metrics, relay.missing))):
                await live(program)


if __name__ == "__main__":
    sys.exit(main())
