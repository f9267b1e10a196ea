"""A topic that this node is subscribed to: a connection to each of its publishers that the master names."""

import asyncio
import logging
from collections.abc import Callable, Iterable
from functools import partial

from tcpros import incoming
from tcpros.header import HeaderError
from tcpros.incoming import Incoming, MismatchError, Received
from tcpros.specs import TypeSpec

_log = logging.getLogger(__name__)

FIRST_PAUSE, LONGEST_PAUSE = 0.5, 8.0  # s, between attempts to reach a publisher
# What a publisher sent before it went may still be on its way.
GRACE = 1.0  # s


class Source:
    """One publisher, by the URI of its node."""

    def __init__(self, subscriber: "Subscriber", uri: str) -> None:
        self.connection: Incoming | None = None
        self.tried = asyncio.Event()  # it is connected, or has failed once
        self.trouble = ""  # why it is not connected, as far as that is known
        self._subscriber, self._uri = subscriber, uri
        self._named = asyncio.Event()  # the master has just named it
        self._leaving: asyncio.TimerHandle | None = None
        self.task = asyncio.get_running_loop().create_task(self._run())

    def name(self) -> None:
        """The master names it, perhaps again: try at once what has failed."""
        if self._leaving:
            self._leaving.cancel()
            self._leaving = None
        self._named.set()

    def leave(self, ended: Callable[[], None]) -> None:
        """The master names it no more: `ended` is called after the grace, unless it is named again."""
        if self._leaving is None:
            grace = GRACE if self.connection else 0.0
            self._leaving = asyncio.get_running_loop().call_later(grace, ended)

    def close(self) -> None:
        if self._leaving:
            self._leaving.cancel()
        self.task.cancel()
        if self.connection:
            self.connection.close()

    async def _run(self) -> None:
        pause: float | None = FIRST_PAUSE
        while True:
            self._named.clear()
            try:
                own = self._subscriber
                connection = self.connection = await incoming.connect(
                    own.node, self._uri, own.topic, own.spec, own.received
                )
                self.trouble = ""
                self.tried.set()
                try:
                    reason = await connection.ended
                finally:
                    self.connection = None
                    connection.close()
                _log.debug("%s: the publisher at %s is gone: %s", own.topic, self._uri, reason)
                pause = FIRST_PAUSE if connection.received_messages or pause is None else pause
            except MismatchError as error:
                self._tell(error)
                pause = None
            except (OSError, HeaderError) as error:
                self._tell(str(error) or "no answer")
                pause = pause or FIRST_PAUSE
            self.tried.set()
            try:
                async with asyncio.timeout(pause):
                    await self._named.wait()
                pause = FIRST_PAUSE
            except TimeoutError:
                pause = pause and min(2 * pause, LONGEST_PAUSE)

    def _tell(self, reason: object) -> None:
        """Once, as long as it stays the same; nothing of one that is on its way out."""
        own = self._subscriber
        trouble = f"no messages of {own.topic} come from {self._uri}: {reason}"
        if self.trouble != trouble and not self._leaving:
            self.trouble = trouble
            _log.warning("%s: %s", own.node, trouble)
            own.on_trouble(trouble)


class Subscriber:
    """Made by Node.subscribe. For the event loop's thread."""

    def __init__(
        self, node: str, topic: str, spec: TypeSpec, received: Received, closed: Callable[["Subscriber"], None]
    ) -> None:
        self.node, self.topic, self.spec, self.received = node, topic, spec, received
        self.on_trouble: Callable[[str], None] = lambda _: None  # a publisher cannot be reached: why, once
        self._closed = closed
        self._sources: dict[str, Source] = {}
        self._named = asyncio.Event()  # the master has named publishers, or none
        self._ending: set[asyncio.Task[None]] = set()

    @property
    def connections(self) -> int:
        return len(self.peers())

    def peers(self) -> dict[str, Incoming]:
        """The connections by URI of the publisher, for statistics."""
        return {uri: source.connection for uri, source in self._sources.items() if source.connection}

    def latched(self) -> list[bytes]:
        """The newest message of each latching publisher that is connected."""
        return [peer.latched for peer in self.peers().values() if peer.latched is not None]

    def troubles(self) -> list[str]:
        """Why publishers are not connected."""
        return [source.trouble for source in self._sources.values() if source.trouble]

    def update(self, publishers: Iterable[str]) -> None:
        """The master names these publishers (URIs of their nodes), and no others."""
        self._named.set()
        named = set(publishers)
        for uri in self._sources.keys() - named:
            self._sources[uri].leave(partial(self._end, uri))
        for uri in named:
            if uri in self._sources:
                self._sources[uri].name()
            else:
                self._sources[uri] = Source(self, uri)

    async def settled(self) -> None:
        """Wait until each of the publishers that the master names at first is connected, or has failed once."""
        await self._named.wait()
        for source in tuple(self._sources.values()):
            await source.tried.wait()

    def close(self) -> None:
        """Unregister, and end the connections; `received` is not called any more."""
        for uri in tuple(self._sources):
            self._end(uri)
        self._closed(self)

    async def finished(self) -> None:
        """Wait for the end of what close() has ended."""
        await asyncio.gather(*self._ending, return_exceptions=True)

    def _end(self, uri: str) -> None:
        source = self._sources.pop(uri)
        source.close()
        self._ending.add(source.task)
        source.task.add_done_callback(self._ending.discard)
