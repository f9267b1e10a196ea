"""The connection to one publisher of another node."""

import asyncio
import itertools
import logging
import socket
from collections.abc import Callable, Mapping
from typing import Any

from tcpros import sockets, xmlrpc_client
from tcpros.blocks import BlockError, Blocks
from tcpros.specs import ANY, TypeSpec

_log = logging.getLogger(__name__)

Received = Callable[[bytes, Mapping[str, str]], None]

ANSWER = 10.0  # s, until the connection is there; a publisher is busy, perhaps
# Bytes that are read at once: other connections get their turn after that. A message longer than this comes in
# larger pieces.
PIECE, LARGEST_PIECE = 2**16, 2**20

_numbers = itertools.count()


class MismatchError(Exception):
    """The publisher has another type: to try again is of no use until something changes."""


class Incoming:
    """Calls `received(data, header)` for every message. `ended` becomes the reason when there are no more."""

    def __init__(self, connected: socket.socket, header: Mapping[str, str], received: Received) -> None:
        self.number = next(_numbers)
        self.header = header
        self.info = sockets.describe(connected)
        self.received_bytes = 0
        self.received_messages = 0
        self.latched: bytes | None = None
        """the newest message, if the publisher latches"""
        self._socket = connected
        self._received = received
        self._latching = header.get("latching") == "1"
        self._blocks = Blocks()
        self._loop = asyncio.get_running_loop()
        self.ended: asyncio.Future[str] = self._loop.create_future()
        self._loop.add_reader(connected, self._readable)

    def close(self, reason: str = "closed") -> None:
        if self._socket.fileno() >= 0:
            self._loop.remove_reader(self._socket)
            self._socket.close()
        if not self.ended.done():
            self.ended.set_result(reason)

    def _readable(self) -> None:
        try:
            data = self._socket.recv(min(max(PIECE, self._blocks.missing), LARGEST_PIECE))
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            return self.close(str(error))
        if not data:
            return self.close("the publisher ended it")
        self.received_bytes += len(data)
        try:
            blocks = self._blocks.feed(data)
        except BlockError as error:
            return self.close(str(error))
        for block in blocks:
            self.received_messages += 1
            if self._latching:
                self.latched = block
            try:
                self._received(block, self.header)
            except Exception:
                _log.exception("a message on %s could not be handled", self.header.get("topic"))
            if self._socket.fileno() < 0:  # closed by the receiver
                return


async def connect(node: str, uri: str, topic: str, spec: TypeSpec, received: Received) -> Incoming:
    """Connect the node `node` to the publisher of `topic` whose node has this URI.

    OSError or HeaderError when it comes to nothing within 10 s, MismatchError when the types differ.
    """
    async with asyncio.timeout(ANSWER):
        answer = await xmlrpc_client.call(uri, "requestTopic", node, topic, [["TCPROS"]], timeout=ANSWER)
        connected = await sockets.connect(*tcpros_address(answer))
        try:
            request = {
                "callerid": node,
                "md5sum": spec.md5sum,
                "message_definition": spec.definition,
                "tcp_nodelay": "1",
                "topic": topic,
                "type": spec.name,
            }
            await sockets.send_header(connected, request)
            header = await sockets.read_header(connected)
            check(header, spec)
            return Incoming(connected, header, received)
        except BaseException:
            connected.close()
            raise


def check(header: Mapping[str, str], spec: TypeSpec) -> None:
    """MismatchError when the publisher does not have what the subscriber expects."""
    if "error" in header:
        raise MismatchError(header["error"])
    name, md5sum = header.get("type", ""), header.get("md5sum", "")
    if md5sum != spec.md5sum and ANY not in (md5sum, spec.md5sum):
        raise MismatchError(f"it has {name} ({md5sum}), not {spec.name} ({spec.md5sum})")


def tcpros_address(answer: Any) -> tuple[str, int]:
    """Host and port from the answer to requestTopic. OSError when there is none in it."""
    try:
        code, text, parameters = answer
        if code != 1:
            raise OSError(f"it refuses: {text}")
        protocol, address, port = parameters
        if protocol == "TCPROS" and 0 < int(port) < 2**16:
            return str(address), int(port)
    except (TypeError, ValueError):
        pass
    raise OSError(f"it offers no TCPROS: {answer!r:.200}")
