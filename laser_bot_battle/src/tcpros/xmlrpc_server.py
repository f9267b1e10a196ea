"""A small XML-RPC server on the event loop: one request per connection, all of it bounded."""

import asyncio
import contextlib
import logging
import xmlrpc.client
from collections.abc import Callable
from typing import Any

from laser_bot_battle.arrival import Arrival, current
from laser_bot_battle.listening import Listener
from tcpros import sockets
from tcpros.sockets import GREETING

_log = logging.getLogger(__name__)

MAX_REQUEST = 256 * 2**10  # bytes
MAX_CONNECTIONS = 100


class XmlRpcServer:
    """Answers by `handle(method, arguments)`, whose result goes to the caller."""

    def __init__(self, handle: Callable[[str, tuple[Any, ...]], Any]) -> None:
        self._handle = handle
        self._servers: list[asyncio.Server] = []
        self._connections: set[asyncio.Task[None]] = set()

    async def start(self, listener: Listener) -> None:
        for each in listener.sockets:
            self._servers.append(await asyncio.start_server(self._connected, sock=each, limit=2**14))

    async def close(self) -> None:
        for server in self._servers:
            server.close()
        for task in self._connections:
            task.cancel()
        await asyncio.gather(*self._connections, return_exceptions=True)

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task
        if len(self._connections) >= MAX_CONNECTIONS:
            writer.close()
            return
        self._connections.add(task)
        try:
            here, caller = (writer.get_extra_info(name) for name in ("sockname", "peername"))
            current.set(Arrival(caller[0], here[0]) if here and caller else None)
            async with asyncio.timeout(GREETING):
                await self._serve(reader, writer)
        except (OSError, EOFError, ValueError, asyncio.LimitOverrunError) as error:
            _log.debug("an XML-RPC connection came to nothing: %s", error)
        finally:
            self._connections.discard(task)
            await sockets.end(writer)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.transport.set_write_buffer_limits(0)  # drain waits until all is sent
        request, *fields = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").split("\r\n")
        status, body = "400 Bad Request", b""
        length = _content_length(fields)
        if not request.startswith("POST "):
            status = "405 Method Not Allowed"
        elif 0 < length <= MAX_REQUEST:
            status, body = "200 OK", self._answer(await reader.readexactly(length))
        head = f"HTTP/1.1 {status}\r\nConnection: close\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}"
        writer.write(f"{head}\r\n\r\n".encode() + body)
        await writer.drain()

    def _answer(self, request: bytes) -> bytes:
        try:
            arguments, method = xmlrpc.client.loads(request)
        except Exception as error:  # the parser raises whatever its input makes it to
            return _fault(f"not XML-RPC: {error}")
        try:
            result = self._handle(method or "", arguments)
            return xmlrpc.client.dumps((result,), methodresponse=True).encode()
        except Exception:
            _log.exception("%s failed", method)
            return _fault("internal error")


def _fault(text: str) -> bytes:
    return xmlrpc.client.dumps(xmlrpc.client.Fault(1, text), methodresponse=True).encode()


def _content_length(fields: list[str]) -> int:
    """0 when it is not said."""
    for field in fields:
        name, _, value = field.partition(":")
        if name.lower() == "content-length":
            with contextlib.suppress(ValueError):
                return int(value)
    return 0
