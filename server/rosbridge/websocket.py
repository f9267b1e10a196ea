"""The WebSocket server: sockets, limits, and clients that are slow, silent or rude."""

import asyncio
import contextlib
import logging
import socket
import struct
from http import HTTPStatus
from types import TracebackType
from typing import Self

from websockets.asyncio.server import Server, ServerConnection, broadcast, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from server.rosbridge.bridge import Bridge
from server.rosbridge.handshake import identity_of
from server.rosbridge.outbox import Outbox

_log = logging.getLogger(__name__)

MOST_CLIENTS = 100
LONGEST_MESSAGE = 64 * 2**10  # bytes; longer ones close the socket with 1009
PING_INTERVAL = 5.0  # s
PING_TIMEOUT = 5.0  # s without pong: the line is dead
CLOSE_TIMEOUT = 1.0  # s for the other side to agree to the end
STALL = 5.0  # s in which a client has taken nothing at all: it is given up
# What kernel and transport may hold for a slow client. More would only make its news older.
SEND_BUFFER = 64 * 2**10  # bytes
WRITE_LIMIT = 4 * 2**10  # bytes
# Messages that one client may have handled before the others get their turn.
TURN = 16


class Client:
    """One WebSocket. What cannot be sent at once waits in a bounded outbox."""

    def __init__(self, connection: ServerConnection) -> None:
        host, port, *_ = connection.remote_address or ("nobody", 0)
        self.name = f"{host}:{port}"
        self._connection = connection
        self._outbox = Outbox()
        self._filled = asyncio.Event()
        self._sending_since: float | None = None
        self._socket = connection.transport.get_extra_info("socket")
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)

    def reply(self, text: str) -> None:
        if not self._send_now(text):
            self._outbox.reply(text)
            self._wait()

    def message(self, topic: str, text: str, most: int) -> None:
        """A message of a topic; while the client is slow, the newest `most` are kept."""
        if not self._send_now(text):
            self._outbox.message(topic, text, most)
            self._wait()

    def check(self, now: float) -> None:
        """Give the client up when it has taken nothing for too long (its pings stand in the same queue)."""
        if self._sending_since is not None and now - self._sending_since > STALL:
            self._give_up(f"it has not read for {STALL:g} s")

    async def send_all(self) -> None:
        """Send what comes, until cancelled or the socket is closed."""
        loop = asyncio.get_running_loop()
        with contextlib.suppress(ConnectionClosed):
            while True:
                await self._filled.wait()
                self._filled.clear()
                while self._outbox:
                    self._sending_since = loop.time()
                    await self._connection.send(self._outbox.next())
                self._sending_since = None

    def _send_now(self, text: str) -> bool:
        """Send without a detour by the outbox, unless something is before it."""
        if self._outbox or self._connection.transport.get_write_buffer_size():
            return False
        broadcast((self._connection,), text)
        return True

    def _wait(self) -> None:
        self._filled.set()
        if self._outbox.hopeless:
            self._give_up("it does not read what it has asked for")

    def _give_up(self, reason: str) -> None:
        _log.warning("%s: given up, %s", self.name, reason)
        # reset the connection: the kernel shall not go on with what it still holds for this client
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self._connection.transport.abort()


class WebSocketServer:
    """Listens while in a `with`."""

    def __init__(self, bridge: Bridge, listener: socket.socket) -> None:
        """`listener` is bound, and not listening yet."""
        self._bridge, self._listener = bridge, listener
        self._clients = 0
        self._server: Server

    async def __aenter__(self) -> Self:
        """OSError when the port cannot be had."""
        self._server = await serve(
            self._handle,
            sock=self._listener,
            process_request=self._admit,
            compression=None,  # short messages on a LAN: it would cost more time than it saves
            open_timeout=5,
            ping_interval=PING_INTERVAL,
            ping_timeout=PING_TIMEOUT,
            close_timeout=CLOSE_TIMEOUT,
            max_size=LONGEST_MESSAGE,
            write_limit=WRITE_LIMIT,
            server_header=None,
            logger=quiet_logger(),
        )
        return self

    async def __aexit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        """Close all sockets with 1001."""
        self._server.close()
        await self._server.wait_closed()

    def _admit(self, connection: ServerConnection, request: Request) -> Response | None:
        """The answer to who is not let in. websockets logs nothing about an answer from here."""
        if [protocol.lower() for protocol in request.headers.get_all("Upgrade")] != ["websocket"]:
            # a health check asks like this: it must get the same answer when there is no place for a client
            response = connection.respond(HTTPStatus.UPGRADE_REQUIRED, "this is a WebSocket server\n")
            response.headers["Upgrade"] = "websocket"
            response.headers["Connection"] = "Upgrade"  # beside "close": RFC 9110 7.8 wants it with every Upgrade
            return response
        if self._clients < MOST_CLIENTS:
            return None
        _log.warning("a client is refused: %d are connected", self._clients)
        return connection.respond(HTTPStatus.SERVICE_UNAVAILABLE, "too many clients\n")

    async def _handle(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        headers = connection.request.headers
        identity = identity_of(headers.get("Origin"), headers.get("Host"), headers.get_all("Cookie"))
        client = Client(connection)
        session = self._bridge.connected(client, identity)
        self._clients += 1
        _log.info("%s: connected", client.name)
        sender = asyncio.create_task(client.send_all())
        try:
            handled = 0
            async for text in connection:
                self._bridge.received(session, text)
                handled += 1
                if handled % TURN == 0:
                    await asyncio.sleep(0)
        except ConnectionClosed as closed:
            _log.info("%s: %s", client.name, closed)
        finally:
            self._clients -= 1
            self._bridge.disconnected(session)
            sender.cancel()
            _log.info("%s: disconnected (%s)", client.name, connection.close_code)


def quiet_logger() -> logging.Logger:
    """websockets' own logger: rude clients are worth a line at most, never a traceback."""

    def shorten(record: logging.LogRecord) -> bool:
        error = record.exc_info[1] if record.exc_info else None
        if error is not None:
            record.msg, record.args = f"{record.getMessage()}: {error.__cause__ or error}", ()
            record.exc_info, record.levelno, record.levelname = None, logging.INFO, "INFO"
        return True

    logger = logging.getLogger("websockets.server")
    logger.setLevel(logging.WARNING)
    logger.addFilter(shorten)
    return logger
