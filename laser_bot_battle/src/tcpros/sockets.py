"""Sockets as ROS wants them: addresses by ROS_IP, ROS_HOSTNAME and ROS_IPV6, and the exchange of headers."""

import asyncio
import socket
from collections.abc import Mapping
from contextlib import suppress

import rosgraph.network

from laser_bot_battle import listening
from tcpros.header import LENGTH, MAX_LENGTH, HeaderError, decode, encode

# How long a peer may take to say what it wants.
GREETING = 5.0  # s


def listen() -> listening.Listener:
    """Non-blocking TCP sockets that listen on a free port."""
    listener = listening.bind(rosgraph.network.get_bind_address(), 0)
    listener.listen(128)
    return listener


def _family() -> socket.AddressFamily:
    return socket.AF_INET6 if rosgraph.network.use_ipv6() else socket.AF_INET


def host() -> str:
    """The name or address by which other machines find this one."""
    return str(rosgraph.network.get_host_name())


def tune(connected: socket.socket) -> None:
    """Small messages leave at once; a peer that is gone without a word is noticed within 150 s, as rospy does it."""
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connected.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 60)
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 10)
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 9)


async def connect(address: str, port: int) -> socket.socket:
    """A connected, non-blocking socket. OSError when nobody is there."""
    loop = asyncio.get_running_loop()
    # a name may have addresses of both kinds, and a ROS node listens on one only
    (family, kind, protocol, _, place), *_ = await loop.getaddrinfo(
        address, port, family=_family(), type=socket.SOCK_STREAM
    )
    connected = socket.socket(family, kind, protocol)
    try:
        connected.setblocking(False)
        tune(connected)
        await loop.sock_connect(connected, place)
    except BaseException:
        connected.close()
        raise
    return connected


async def streams(connected: socket.socket) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Takes the socket over.

    uvloop, cancelled while it does that, closes the file descriptor and leaves it to the socket object, which closes it
    again: by then it may be another connection's.
    """
    opening = asyncio.ensure_future(asyncio.open_connection(sock=connected))
    try:
        return await asyncio.shield(opening)
    except asyncio.CancelledError:
        opening.add_done_callback(_abort)
        raise


async def end(writer: asyncio.StreamWriter) -> None:
    """End the connection at once. Why it ended before was told to whoever read: asyncio, which else tells it once more
    whenever it forgets the connection, is told that."""
    writer.transport.abort()
    with suppress(OSError):
        await writer.wait_closed()


def _abort(opening: asyncio.Future[tuple[asyncio.StreamReader, asyncio.StreamWriter]]) -> None:
    if not opening.cancelled() and not opening.exception():
        opening.result()[1].transport.abort()


async def send_header(connected: socket.socket, fields: Mapping[str, str]) -> None:
    await asyncio.get_running_loop().sock_sendall(connected, encode(fields))


async def read_header(connected: socket.socket) -> dict[str, str]:
    """The peer's header, and not a byte more. HeaderError when it is none, OSError when the connection ends."""
    (length,) = LENGTH.unpack(await _read(connected, 4))
    if length > MAX_LENGTH:
        raise HeaderError(f"a header of {length} bytes")
    return decode(await _read(connected, length))


async def _read(connected: socket.socket, length: int) -> bytes:
    loop = asyncio.get_running_loop()
    data = bytearray()
    while len(data) < length:
        piece = await loop.sock_recv(connected, min(length - len(data), 2**16))
        if not piece:
            raise ConnectionError("the peer ended the connection")
        data += piece
    return bytes(data)


def describe(connected: socket.socket) -> str:
    """The connection as getBusInfo tells it; rosnode reads this text."""
    port = connected.getsockname()[1]
    return f"TCPROS connection on port {port} to [{peer_of(connected)} on socket {connected.fileno()}]"


def peer_of(connected: socket.socket) -> str:
    """host:port, for people."""
    try:
        return ":".join(str(part) for part in connected.getpeername()[:2])
    except OSError:
        return "a peer that is gone"
