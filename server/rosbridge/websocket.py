"""The WebSocket server: who is let in, and how much a client may send."""

import asyncio
import logging
import socket
from http import HTTPStatus
from types import TracebackType
from typing import Self

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from server.rosbridge.bridge import Bridge
from server.rosbridge.connection import Connection
from server.rosbridge.handshake import identity_of

_log = logging.getLogger(__name__)

MAX_CLIENTS = 100
MAX_MESSAGE_SIZE = 64 * 2**10  # bytes; longer messages close the socket with 1009
PING_INTERVAL = 5.0  # s
PING_TIMEOUT = 5.0  # s without pong: the line is dead
CLOSE_TIMEOUT = 1.0  # s for the other side to agree to the end
# What the transport may hold for a slow client. More would only make its news older.
WRITE_LIMIT = 4 * 2**10  # bytes
# Messages that one client may have handled before the others get their turn.
MESSAGES_PER_TURN = 16


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
            max_size=MAX_MESSAGE_SIZE,
            write_limit=WRITE_LIMIT,
            server_header=None,
            logger=quiet_logger(),
        )
        return self

    async def __aexit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        """Close all sockets with 1001."""
        self._server.close()
        await self._server.wait_closed()

    def _admit(self, websocket: ServerConnection, request: Request) -> Response | None:
        """The answer to who is not let in. websockets logs nothing about an answer from here."""
        if [protocol.lower() for protocol in request.headers.get_all("Upgrade")] != ["websocket"]:
            # who asks whether this is alive gets the same answer when there is no place for a client
            response = websocket.respond(HTTPStatus.UPGRADE_REQUIRED, "this is a WebSocket server\n")
            response.headers["Upgrade"] = "websocket"
            response.headers["Connection"] = "Upgrade"  # beside "close": RFC 9110 7.8 wants it with every Upgrade
            return response
        if self._clients < MAX_CLIENTS:
            return None
        _log.warning("a client was refused: %d are connected", self._clients)
        return websocket.respond(HTTPStatus.SERVICE_UNAVAILABLE, "too many clients\n")

    async def _handle(self, websocket: ServerConnection) -> None:
        assert websocket.request is not None
        headers = websocket.request.headers
        identity = identity_of(headers.get("Origin"), headers.get("Host"), headers.get_all("Cookie"))
        connection = Connection(websocket)
        client = self._bridge.connected(connection, identity)
        self._clients += 1
        _log.info("%s: connected", connection.name)
        sender = asyncio.create_task(connection.send_all())
        try:
            handled = 0
            async for text in websocket:
                self._bridge.received(client, text)
                handled += 1
                if handled % MESSAGES_PER_TURN == 0:
                    await asyncio.sleep(0)
        except ConnectionClosed as closed:
            _log.info("%s: %s", connection.name, closed)
        finally:
            self._clients -= 1
            self._bridge.disconnected(client)
            sender.cancel()
            _log.info("%s: disconnected (%s)", connection.name, websocket.close_code)


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
