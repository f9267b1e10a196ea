"""rospy, guarded against peers that connect and stall, or that promise gigabytes.

rospy reads the greeting of a new connection in the thread that accepts connections, without a time-out. One peer that
falls silent there (a robot that loses its Wi-Fi, the master that sends an HTTP call to a port that had another owner)
would block the node for ever: no more service calls, no more subscribers. And it keeps all of a header or of a message
that somebody declares to be 4 GiB long.
"""

import contextlib
import socket
import struct
import threading
from io import BytesIO

from rosgraph.network import ROSHandshakeException, read_ros_handshake_header
from rospy.exceptions import TransportTerminated
from rospy.impl import tcpros_base, tcpros_service

from laser_bot_battle.tcp_places import Places
from laser_bot_battle.xmlrpc_guard import guard_xmlrpc

PEER = "laserbot_peer"  # a field of the connection headers that `name_peers` adds: the peer's address
GREETING = 5.0  # s
MAX_HEADER = 2**20  # bytes
MAX_MESSAGE = 4 * 2**20  # bytes; what the nodes with rospy exchange has some hundred
# each has a thread, a call for ever when its request does not come
MAX_GREETINGS = 200
MAX_CALLS, MAX_CALLS_OF_ONE_MACHINE = 200, 40
CALL = 60.0  # s; who takes longer goes when there are too many

_LENGTH = struct.Struct("<I")
_receive = tcpros_base.recv_buff


def guard_rospy() -> None:
    """Bound what peers may send, and how long it may take. Call it once, before `init_node`."""
    guard_xmlrpc()
    tcpros_base.read_ros_handshake_header = _read_header
    tcpros_base.recv_buff = tcpros_service.recv_buff = _receive_bounded
    server = tcpros_base.init_tcpros_server()
    greet = server._tcp_server_callback
    places = threading.BoundedSemaphore(MAX_GREETINGS)

    def greet_in_time(peer: socket.socket, address: tuple[str, int]) -> None:
        timer = threading.Timer(GREETING, _cut, [peer])
        timer.daemon = True
        timer.start()
        try:
            greet(peer, address)
        finally:
            timer.cancel()
            places.release()

    def accept(peer: socket.socket, address: tuple[str, int]) -> None:
        if places.acquire(blocking=False):
            threading.Thread(target=greet_in_time, args=(peer, address), daemon=True).start()
        else:
            peer.close()

    server._tcp_server_callback = accept


def guard_services() -> None:
    """Bound the calls of this node's services, and let their handlers know who calls: the requests' connection headers
    get `PEER`, whatever the caller says there. Call it once, after `init_node`."""
    server = tcpros_base.init_tcpros_server()
    handle = server.service_connection_handler
    calls = Places(MAX_CALLS, CALL, MAX_CALLS_OF_ONE_MACHINE)

    def handle_bounded(peer: socket.socket, address: tuple[str, int], header: dict[str, str]) -> str | None:
        if not calls.take(peer, address[0]):
            return "too many calls at once"
        header[PEER] = address[0]
        answer: str | None = handle(peer, address, header)
        return answer

    server.service_connection_handler = handle_bounded


def _read_header(peer: socket.socket, buffer: BytesIO, size: int) -> dict[str, str]:
    while buffer.tell() < _LENGTH.size:
        piece = peer.recv(_LENGTH.size - buffer.tell())
        if not piece:
            raise ROSHandshakeException("the peer ended the connection before its header")
        buffer.write(piece)
    (length,) = _LENGTH.unpack(buffer.getvalue())
    if length > MAX_HEADER:
        raise ROSHandshakeException(f"a header of {length} bytes")
    header: dict[str, str] = read_ros_handshake_header(peer, buffer, size)
    return header


def _receive_bounded(peer: socket.socket, buffer: BytesIO, size: int) -> int:
    if buffer.tell() > MAX_MESSAGE:
        raise TransportTerminated(f"a message of more than {MAX_MESSAGE} bytes")
    received: int = _receive(peer, buffer, size)
    return received


def _cut(peer: socket.socket) -> None:
    with contextlib.suppress(OSError):  # closed meanwhile
        peer.shutdown(socket.SHUT_RDWR)
