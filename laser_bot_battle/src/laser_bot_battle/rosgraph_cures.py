"""Cures for rosgraph's faults in the ROS master and in each rospy node.

- **Endless requests**: its XML-RPC server has a thread for each connection, which waits for ever for what the caller
  has promised, and keeps all of it. Shown by tests/integration/tcpros/test_cures.py.
- **One family**: it listens by IPv4 only, or by IPv6 only. Shown by tests/integration/test_battle.py.
"""

import re
import socket
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

from rosgraph import xmlrpc

from laser_bot_battle import listening
from laser_bot_battle.arrival import Arrival, current
from laser_bot_battle.connection_limits import ConnectionLimits

PATIENCE = 5.0  # s for a request, or until the next one of a connection: whoever asks then connects anew
MAX_REQUEST = 4 * 2**20  # bytes
MAX_CONNECTIONS = 300
MAX_OF_ONE_MACHINE = 60


def cure_xmlrpc() -> None:
    """Call it once, before the ROS master or `init_node` starts its server."""
    xmlrpc.SilenceableXMLRPCRequestHandler = _Handler
    xmlrpc.ThreadingXMLRPCServer = _Server


class _Handler(xmlrpc.SilenceableXMLRPCRequestHandler):  # type: ignore[misc]
    """Answers the requests of one connection, in a thread."""

    server_version, sys_version = "ROS", ""  # no versions for strangers

    def handle_one_request(self) -> None:
        self.server.limits.renew(self.request)
        current.set(Arrival(self.client_address[0], self.request.getsockname()[0]))
        super().handle_one_request()

    def do_POST(self) -> None:  # noqa: N802 - http.server's name
        length = self.headers.get("Content-Length", "")
        if re.fullmatch("[0-9]{1,9}", length) and int(length) <= MAX_REQUEST:
            super().do_POST()
        else:
            self.close_connection = True
            self.send_error(413)


class _Server(xmlrpc.ThreadingXMLRPCServer):  # type: ignore[misc]
    request_queue_size = 128  # connections that the kernel holds until they are accepted, as rosgraph has it

    def __init__(self, address: tuple[str, int], log_requests: bool = True) -> None:
        self.limits = ConnectionLimits(MAX_CONNECTIONS, PATIENCE, MAX_OF_ONE_MACHINE)
        SimpleXMLRPCServer.__init__(self, address, _Handler, log_requests, bind_and_activate=False)
        self.server_close()  # the socket that it has made itself
        self.socket = listening.bind(*address)  # it does all that the server asks of one
        self.server_address = self.socket.getsockname()
        self.server_activate()

    def verify_request(self, request: socket.socket, client_address: tuple[Any, ...]) -> bool:
        return self.limits.take(request, client_address[0])

    def service_actions(self) -> None:
        """Called by `serve_forever` after each connection, and twice a second."""
        self.limits.cut_overdue()
