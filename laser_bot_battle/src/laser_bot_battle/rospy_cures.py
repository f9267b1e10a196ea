"""Cures for rospy's faults, each named by its fault. Those of the XML-RPC server below it are in `rosgraph_cures`.

- **Stalled greeting**: the thread that accepts connections reads each one's header, without a time-out. A robot that
  loses its Wi-Fi there blocks the node for ever. `cure_rospy`, shown by tests/integration/tcpros/test_cures.py.
- **Endless header, endless message**: all of what somebody declares to be 4 GiB long is kept. The same.
- **One family**: it listens by IPv4 only, or by IPv6 only. `cure_rospy`, shown by tests/integration/test_battle.py.
- **Countless calls, unknown callers**: each call of a service has a thread for as long as its caller likes, and the
  handler cannot tell who calls. `cure_services`, shown by the same tests.
- **Missed publisher**: one that appears in the moment of subscribing, or did not answer at once, is forgotten.
  `Subscription` and `hear_again`, shown by tests/unit/shared/test_subscriptions.py.
- **Late latch**: a publisher registers first and latches then. Who connects in between is told that it does not latch.
  `latched_publisher`, shown by tests/unit/shared/test_latched.py.
- **One address for everybody**: a subscriber from another network of this machine is sent to an address that it does
  not reach. `cure_rospy`, shown by tests/integration/discovery/test_networks.py.
"""

import contextlib
import logging
import socket
import struct
import threading
from collections.abc import Callable, Iterable
from io import BytesIO

import genpy
import rospy
from rosgraph.network import ROSHandshakeException, get_bind_address, read_ros_handshake_header
from rospy import topics
from rospy.exceptions import TransportTerminated
from rospy.impl import tcpros_base, tcpros_pubsub, tcpros_service
from rospy.impl.registration import Registration, get_topic_manager

from laser_bot_battle import listening
from laser_bot_battle.arrival import current, host_for
from laser_bot_battle.connection_limits import ConnectionLimits
from laser_bot_battle.master import Master, MasterError
from laser_bot_battle.netlink import own_networks
from laser_bot_battle.rosgraph_cures import cure_xmlrpc

PEER = "laserbot_peer"  # a field of the connection headers that `name_peers` adds: the peer's address
BACKLOG = 5  # connections that the kernel holds until they are accepted, as rospy has it
GREETING = 5.0  # s
MAX_HEADER = 2**20  # bytes
MAX_MESSAGE = 4 * 2**20  # bytes; what the nodes with rospy exchange has some hundred
# each has a thread, a call for ever when its request does not come
MAX_GREETINGS = 200
MAX_CALLS, MAX_CALLS_OF_ONE_MACHINE = 200, 40
CALL = 60.0  # s; those that take longer go when there are too many
UNHEARD = 2.0  # s without a publisher until it may have been missed

_log = logging.getLogger(__name__)

_LENGTH = struct.Struct("<I")
_receive = tcpros_base.recv_buff


def cure_rospy() -> None:
    """Stalled greetings, endless headers and messages, one family, one address for everybody. Call it once, before
    `init_node`."""
    cure_xmlrpc()
    tcpros_base.TCPServer._create_server_sock = _listen
    tcpros_pubsub.get_tcpros_server_address = _address_for_the_caller
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


def cure_services() -> None:
    """Countless calls, unknown callers: the requests' connection headers get `PEER`, whatever the caller says there.
    Call it once, after `init_node`."""
    server = tcpros_base.init_tcpros_server()
    handle = server.service_connection_handler
    calls = ConnectionLimits(MAX_CALLS, CALL, MAX_CALLS_OF_ONE_MACHINE)

    def handle_bounded(peer: socket.socket, address: tuple[str, int], header: dict[str, str]) -> str | None:
        if not calls.take(peer, address[0]):
            return "too many calls at once"
        header[PEER] = address[0]
        answer: str | None = handle(peer, address, header)
        return answer

    server.service_connection_handler = handle_bounded


class Subscription:
    """Of one topic, open until `close`. Opened, opened again and closed by one thread, asked by any."""

    def __init__(self, subscribe: Callable[[], rospy.Subscriber], now: float) -> None:
        self._subscribe, self._since = subscribe, now
        self._lock = threading.Lock()  # a subscriber is good for nothing once it is closed
        self._subscriber: rospy.Subscriber | None = subscribe()
        self.name = str(self._subscriber.resolved_name)

    def is_connected(self) -> bool:
        """Whether somebody publishes here."""
        with self._lock:
            return self._subscriber is not None and self._subscriber.get_num_connections() > 0

    def is_unheard(self, now: float) -> bool:
        """Whether nobody has been heard for a while."""
        return now - self._since >= UNHEARD and not self.is_connected()

    def hear_again(self, now: float) -> None:
        """Subscribe anew."""
        self.close()
        self._since, self._subscriber = now, self._subscribe()

    def close(self) -> None:
        with self._lock:
            subscriber, self._subscriber = self._subscriber, None
        if subscriber is not None:
            subscriber.unregister()  # asks the ROS master, so nobody must have to wait for it


def latched_publisher(topic: str, kind: type[genpy.Message], queue_size: int) -> rospy.Publisher:
    """One that latches before anybody can connect."""
    manager = get_topic_manager()
    name = rospy.resolve_name(topic)
    with manager.lock:
        if manager.get_publisher_impl(name) is None:
            latching = topics._PublisherImpl(name, kind)
            latching.enable_latch()
            manager._add(latching, manager.pubs, Registration.PUB)
        return rospy.Publisher(topic, kind, latch=True, queue_size=queue_size)


def hear_again(subscriptions: Iterable[Subscription], master: Master, now: float) -> None:
    """Subscribe anew where nobody is heard although somebody publishes, as a missed publisher does. Not elsewhere, as
    with a robot that never reports its health: rospy leaves a descriptor to the garbage collector each time."""
    unheard = [subscription for subscription in subscriptions if subscription.is_unheard(now)]
    if not unheard:
        return
    try:
        published = {name for name, _ in master.call("getPublishedTopics", "")}
    except (OSError, MasterError, ValueError) as error:
        _log.debug("the ROS master does not say what is published: %s", error)
        return
    for subscription in unheard:
        if subscription.name in published:
            subscription.hear_again(now)


def _listen(server: tcpros_base.TCPServer) -> listening.Listener:
    listener = listening.bind(get_bind_address(), server.port)
    server.addr, server.port, *_ = listener.getsockname()
    listener.listen(BACKLOG)
    return listener


def _address_for_the_caller() -> tuple[str, int]:
    host, port = tcpros_base.get_tcpros_server_address()
    return host_for(host, current.get(), own_networks()), port


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
