"""Debian's ROS master with limits, for several networks: `python3 -m server.ros.master -p 11311`.

As `rosmaster --core`, but a peer that stalls or floods holds no thread for ever, no file of its log grows, and a port
that is taken ends it.
"""

import argparse
import contextlib
import logging
import signal
import sys
import threading
from queue import Empty, SimpleQueue

from rosgraph.xmlrpc import XmlRpcNode
from rosmaster.master_api import NUM_WORKERS

from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import ROS_PORT
from laser_bot_battle.rosgraph_cures import cure_xmlrpc
from laser_bot_battle.settings import describe, port, read_or_exit
from laser_bot_battle.variables import LOG_LEVEL
from server.ros.master_networks import NetworksHandler

POLL = 0.5  # s

_log = logging.getLogger(__name__)


def main() -> int:
    """The program; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="server.ros.master",
        description=__doc__,
        epilog=describe(LOG_LEVEL),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("-p", "--port", default=str(ROS_PORT), help="default %(default)s")
    place = port("--port", ROS_PORT, "")
    number = read_or_exit("server.ros.master", place.read, {place.name: parser.parse_args().port})
    configure_logging(read_or_exit("server.ros.master", LOG_LEVEL.read))
    ends: SimpleQueue[int] = SimpleQueue()  # exit codes; handlers of signals may use it
    for end in (signal.SIGINT, signal.SIGTERM):
        signal.signal(end, lambda *_: ends.put(0))

    cure_xmlrpc()

    def failed(error: Exception) -> None:
        _log.error("cannot serve port %d: %s", number, getattr(error, "strerror", None) or error)
        ends.put(1)

    handler = NetworksHandler(NUM_WORKERS)
    node = XmlRpcNode(number, handler, on_run_error=failed)
    threading.Thread(target=node.run, name="master", daemon=True).start()
    while handler._ok():  # who knows its API may have ended it
        with contextlib.suppress(Empty):
            return ends.get(timeout=POLL)
    return 0


if __name__ == "__main__":
    sys.exit(main())
