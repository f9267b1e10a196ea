"""Lets the master, and nobody else, to the camera's pictures: in front of ustreamer, which knows no addresses."""

import asyncio
import contextlib
import logging
import re
from collections.abc import Awaitable, Callable
from pathlib import Path

MAX_REQUEST = 4096  # bytes of a request with its headers
MAX_GUESTS = 4  # the master needs one, or two while it connects again
REQUEST_SECONDS = 3.0
CHUNK = 65_536
_ALLOWED = re.compile(rb"GET /(stream|snapshot|state)(\?[\w=&.-]*)? HTTP/1\.[01]\r\n")

_log = logging.getLogger(__name__)


class MasterOnly:
    """A TCP server; each connection of the master's is joined to one of ustreamer's, on its Unix socket."""

    def __init__(self, socket: Path, may_enter: Callable[[str], Awaitable[bool]]) -> None:
        """`may_enter` tells of an IP address whether it is the master's."""
        self._socket, self._may_enter = socket, may_enter
        self._guests: set[asyncio.Task[None]] = set()
        self._refused: set[str] = set()
        self._server: asyncio.Server | None = None

    async def open(self, port: int) -> None:
        """OSError if the port cannot be had."""
        self._server = await asyncio.start_server(self._greet, port=port, limit=MAX_REQUEST)

    async def close(self) -> None:
        if self._server:
            self._server.close()
        for guest in self._guests:
            guest.cancel()
        await asyncio.gather(*self._guests, return_exceptions=True)

    async def _greet(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task
        self._guests.add(task)
        try:
            with contextlib.suppress(OSError, asyncio.CancelledError):
                await self._serve(reader, writer)
        finally:
            self._guests.discard(task)
            writer.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        address = writer.get_extra_info("peername")[0]
        if len(self._guests) > MAX_GUESTS:
            await _refuse(writer, 503, "too many connections")
            return
        if not await self._may_enter(address):
            if address not in self._refused and len(self._refused) < 100:
                self._refused.add(address)
                _log.warning("%s wanted pictures: refused, it is not the master", address)
            await _refuse(writer, 403, "only the master gets this robot's pictures")
            return
        try:
            async with asyncio.timeout(REQUEST_SECONDS):
                request = await reader.readuntil(b"\r\n\r\n")
        except (asyncio.IncompleteReadError, asyncio.LimitOverrunError, TimeoutError):
            return
        if not _ALLOWED.match(request):
            await _refuse(writer, 404, "there are /stream, /snapshot and /state")
            return
        try:
            source, sink = await asyncio.open_unix_connection(self._socket)
        except OSError:
            await _refuse(writer, 503, "the camera's program has not started yet")
            return
        try:
            sink.write(request)
            leaving = asyncio.create_task(reader.read(1))  # nothing more is expected but the end
            carrying = asyncio.create_task(_carry(source, writer))
            try:
                await asyncio.wait([leaving, carrying], return_when=asyncio.FIRST_COMPLETED)
            finally:
                leaving.cancel()
                carrying.cancel()
                await asyncio.gather(leaving, carrying, return_exceptions=True)
        finally:
            sink.close()


async def _carry(source: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await source.read(CHUNK):
        writer.write(data)
        await writer.drain()


async def _refuse(writer: asyncio.StreamWriter, code: int, text: str) -> None:
    body = f"{text}\n".encode()
    head = f"HTTP/1.0 {code} Refused\r\nContent-Type: text/plain\r\nContent-Length: {len(body)}\r\n\r\n"
    writer.write(head.encode() + body)
    await writer.drain()
