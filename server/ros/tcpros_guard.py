"""rospy's TCP server, guarded against peers that connect and then stall.

rospy reads the greeting of a new connection in the thread that accepts connections, without a time-out. One peer that
falls silent there (a robot that loses its Wi-Fi, the master that sends an HTTP call to a port that had another owner)
would block the node for ever: no more service calls, no more subscribers.
"""

import contextlib
import socket
import threading

from rospy.impl.tcpros_base import init_tcpros_server

PEER = "laserbot_peer"  # a field of the connection headers that `name_peers` adds: the peer's address


def guard_handshakes(timeout: float = 5.0) -> None:
    """Greet every peer in a thread of its own, for at most `timeout` seconds. Call it once, before `init_node`."""
    server = init_tcpros_server()
    greet = server._tcp_server_callback

    def greet_in_time(peer: socket.socket, address: tuple[str, int]) -> None:
        timer = threading.Timer(timeout, _cut, [peer])
        timer.daemon = True
        timer.start()
        try:
            greet(peer, address)
        finally:
            timer.cancel()

    def accept(peer: socket.socket, address: tuple[str, int]) -> None:
        threading.Thread(target=greet_in_time, args=(peer, address), daemon=True).start()

    server._tcp_server_callback = accept


def name_peers() -> None:
    """Let the handlers of services know who calls: their requests' connection headers get `PEER`, whatever the caller
    says there. Call it once, after `init_node`."""
    server = init_tcpros_server()
    handle = server.service_connection_handler

    def handle_named(peer: socket.socket, address: tuple[str, int], header: dict[str, str]) -> str | None:
        header[PEER] = address[0]
        answer: str | None = handle(peer, address, header)
        return answer

    server.service_connection_handler = handle_named


def _cut(peer: socket.socket) -> None:
    with contextlib.suppress(OSError):  # closed meanwhile
        peer.shutdown(socket.SHUT_RDWR)
