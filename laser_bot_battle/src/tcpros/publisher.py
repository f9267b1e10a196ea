"""A topic that this node publishes."""

import asyncio
import math
import socket
from collections.abc import Callable, Hashable, Mapping

from tcpros.header import LENGTH
from tcpros.outgoing import Backlog, Outgoing
from tcpros.specs import TypeSpec

# So long after its begin a publisher keeps its messages for subscribers that were there before it: they connect when
# the master has told them of it.
EARLY = 10.0  # s
# So long after the master knows the publisher, others get them, too: who subscribes at the same moment. Later they do
# not: a robot must not act on commands from before its start.
SAME_MOMENT = 1.0  # s

MOST_LATCHED = 16  # messages, of so many sources

# With `latest`, what the kernel may hold for a subscriber that does not read: the commands of about a second, so that
# after a short disturbance of the radio the last one, neutral perhaps, gets through.
LATEST_BUFFER = 16 * 2**10  # bytes


class Publisher:
    """Made by Node.advertise. For the event loop's thread."""

    def __init__(
        self, topic: str, spec: TypeSpec, latch: bool, latest: bool, closed: Callable[["Publisher"], None]
    ) -> None:
        self.topic, self.spec, self.latch, self.latest = topic, spec, latch and not latest, latest
        self.published_bytes = 0
        self._closed = closed
        self._connections: set[Outgoing] = set()
        self._turn: list[bytes] = []  # what was published in this turn of the event loop
        self._latched: dict[Hashable, bytes] = {}  # the last message of each source, the newest last
        self._early = None if latest else Backlog()
        self._early_for: set[str] = set()  # nodes that were there before and have not connected yet
        self._moment_end = math.inf
        self._loop = asyncio.get_running_loop()
        self._early_end = self._loop.call_later(EARLY, self._forget_early)

    @property
    def connections(self) -> int:
        return len(self._connections)

    def peers(self) -> list[Outgoing]:
        """The connections, for statistics."""
        return list(self._connections)

    def registered(self, nodes: set[str]) -> None:
        """The master knows this publisher; these nodes had subscribed before."""
        self._early_for = nodes - {connection.callerid for connection in self._connections}
        self._moment_end = self._loop.time() + SAME_MOMENT

    def publish(self, data: bytes, source: Hashable = None) -> None:
        """A serialized message, without its length. It leaves at the end of this turn of the event loop, in one piece
        with the others of the turn; with `latest` it leaves now, or is dropped. The last one of each `source` is
        latched, as if the sources were nodes of their own."""
        frame = LENGTH.pack(len(data)) + data
        if self.latest:
            self._send([frame])
            return
        if not self._turn:
            self._loop.call_soon(self._flush)
        self._turn.append(frame)
        if self.latch:
            self._latched.pop(None, None)  # that of the sources before
            self._latched.pop(source, None)
            self._latched[source] = frame
            if len(self._latched) > MOST_LATCHED:
                del self._latched[next(iter(self._latched))]

    def unlatch(self, source: Hashable) -> None:
        """That source is gone."""
        self._latched.pop(source, None)

    def orphan(self) -> None:
        """All sources are gone. The newest message stays until there is another one."""
        if self._latched:
            self._latched = {None: self._latched.popitem()[1]}

    def latched(self) -> list[bytes]:
        """The messages that newcomers get, without their lengths."""
        return [frame[LENGTH.size :] for frame in self._latched.values()]

    def add(self, connected: socket.socket, header: Mapping[str, str]) -> None:
        """A subscriber that has said its header and heard ours."""
        self._flush()
        if self.latest:
            connected.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, LATEST_BUFFER)
        connection = Outgoing(connected, header, self._connections.discard, queue=not self.latest)
        self._connections.add(connection)
        if missed := self._missed(connection.callerid):
            connection.send(missed, b"".join(missed))

    def close(self) -> None:
        """Unregister, and end the connections. What waits for a subscriber that does not read is lost to it."""
        self._flush()
        self._early_end.cancel()
        self._early = None
        for connection in tuple(self._connections):
            connection.close()
        self._closed(self)

    def header(self, callerid: str) -> dict[str, str]:
        """What a subscriber is told."""
        return {
            "callerid": callerid,
            "latching": "1" if self.latch else "0",
            "md5sum": self.spec.md5sum,
            "message_definition": self.spec.definition,
            "topic": self.topic,
            "type": self.spec.name,
        }

    def _flush(self) -> None:
        if not self._turn:
            return
        frames, self._turn = self._turn, []
        self._send(frames)
        if self._early is not None:
            self._early.add(frames)

    def _missed(self, node: str) -> list[bytes]:
        """What a node that has just connected must get."""
        if self._early is not None and (node in self._early_for or self._loop.time() < self._moment_end):
            self._early_for.discard(node)
            return self._early.all()
        return list(self._latched.values())

    def _send(self, frames: list[bytes]) -> None:
        joined = frames[0] if len(frames) == 1 else b"".join(frames)
        self.published_bytes += len(joined)
        for connection in tuple(self._connections):
            connection.send(frames, joined)

    def _forget_early(self) -> None:
        self._early = None
