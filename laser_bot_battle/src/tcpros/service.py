"""A service that this node offers."""

import asyncio
import logging
import socket
from collections.abc import Awaitable, Callable, Mapping

from tcpros import sockets
from tcpros.blocks import MAX_LENGTH
from tcpros.header import LENGTH
from tcpros.specs import ServiceFailure, ServiceSpec

_log = logging.getLogger(__name__)

# How long a caller may take to send its request, and to take the response.
TRANSFER = 30.0  # s

Handler = Callable[[bytes], Awaitable[bytes]]


class Service:
    """Made by Node.serve. For the event loop's thread."""

    def __init__(self, name: str, spec: ServiceSpec, handler: Handler, closed: Callable[["Service"], None]) -> None:
        self.name, self.spec = name, spec
        self._handler = handler
        self._closed = closed
        self._callers: set[asyncio.Task[None]] = set()

    def header(self, callerid: str) -> dict[str, str]:
        """What a caller is told."""
        return {"callerid": callerid, "md5sum": self.spec.md5sum, "service": self.name, "type": self.spec.name}

    async def accept(self, connected: socket.socket, header: Mapping[str, str]) -> None:
        """Answer a caller that has said its header and heard ours. Takes the socket over."""
        task = asyncio.current_task()
        assert task
        self._callers.add(task)
        try:
            reader, writer = await sockets.streams(connected)
            try:
                await self._answer_calls(reader, writer, header.get("persistent", "").lower() in ("1", "true"))
            finally:
                await sockets.end(writer)
        except (OSError, EOFError) as error:
            _log.debug("%s: a caller went away: %s", self.name, error)
        finally:
            self._callers.discard(task)

    async def _answer_calls(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, persistent: bool) -> None:
        writer.transport.set_write_buffer_limits(0)  # drain waits until all is sent
        while True:
            async with asyncio.timeout(None if persistent else TRANSFER):
                request = await read_block(reader)
            writer.write(await self._answer(request))
            async with asyncio.timeout(TRANSFER):
                await writer.drain()
            if not persistent:
                return

    def close(self) -> None:
        """Unregister, and cut those that wait for an answer."""
        for task in self._callers:
            task.cancel()
        self._closed(self)

    async def _answer(self, request: bytes) -> bytes:
        try:
            response = await self._handler(request)
        except ServiceFailure as failure:
            text = str(failure).encode(errors="replace")
        except Exception:
            _log.exception("the service %s failed", self.name)
            text = b"internal error"
        else:
            return b"\1" + LENGTH.pack(len(response)) + response
        return b"\0" + LENGTH.pack(len(text)) + text


async def read_block(reader: asyncio.StreamReader) -> bytes:
    """A length and that many bytes. OSError when they are too many, EOFError when they do not come."""
    (length,) = LENGTH.unpack(await reader.readexactly(4))
    if length > MAX_LENGTH:
        raise OSError(f"it sends {length} bytes, more than {MAX_LENGTH}")
    return await reader.readexactly(length)
