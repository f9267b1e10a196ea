"""The game server of the master (manual 3.1.1): referee, web server and the ROS node `robots_server` in one process."""

import logging
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import waitress
from waitress import wasyncore

from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import SERVER_NODE
from laser_bot_battle.settings import read_or_exit
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.node import Node, parse_arguments
from server.pulse import Pulse
from server.ros.hits import Hits
from server.ros.id_service_server import IdServiceServer
from server.ros.status import StatusPublisher
from server.settings import VARIABLES, Settings
from server.store.roster import Roster
from server.web.app import create_app

_log = logging.getLogger(__name__)

_CLOSE_WITHIN = 0.5  # s


def main() -> int:
    """The program; returns its exit code."""
    description = "The game server: referee, web server and the ROS node robots_server."
    parse_arguments("server.main", description, *VARIABLES)
    settings = read_or_exit("server.main", Settings.from_env)
    configure_logging(settings.node.log_level)
    node = Node(SERVER_NODE, settings.node)
    return node.run(lambda listener: _serve(node, settings, listener))


@contextmanager
def _serve(node: Node, settings: Settings, listener: socket.socket) -> Iterator[None]:
    roster = Roster(settings.data, settings.roster)
    game = GameLoop(Referee(settings.rules, roster.load()))
    hits = Hits(game)
    game.add_listener(StatusPublisher().publish)
    game.add_listener(hits.follow)
    IdServiceServer(game, roster)
    channels: dict[int, wasyncore.dispatcher] = {}
    web = waitress.create_server(
        create_app(game, settings),
        map=channels,
        sockets=[listener],
        threads=8,
        connection_limit=500,
        channel_timeout=30,
        asyncore_use_poll=True,  # select() ends at 1024 files
        max_request_body_size=1 << 20,  # what the application then refuses politely
    )
    game.add_listener(Pulse(web).follow)
    game.start()
    node.start_thread("hits", hits.run)
    serving = node.start_thread("web server", web.run)
    _log.info("serving the game at http://%s:%d", settings.node.bind, settings.node.port)
    try:
        yield
    finally:
        game.stop()
        with suppress(OSError):  # the loop was awake, and has closed the trigger before it was pulled
            web.trigger.pull_trigger(lambda: wasyncore.close_all(channels))  # in its thread: it may be accepting now
        serving.join(_CLOSE_WITHIN)
        hits.stop()


if __name__ == "__main__":
    sys.exit(main())
