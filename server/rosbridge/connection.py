"""One client's WebSocket, which may be slow or dead."""

import asyncio
import contextlib
import logging
import socket
import struct

from websockets.asyncio.server import ServerConnection, broadcast
from websockets.exceptions import ConnectionClosed

from server.rosbridge.outbox import Outbox

_log = logging.getLogger(__name__)

STALL = 5.0  # s in which a client has taken nothing at all: it is given up
# What the kernel may hold for a slow client. More would only make its news older.
SEND_BUFFER = 64 * 2**10  # bytes


class Connection:
    """What cannot be sent at once waits in a bounded outbox."""

    def __init__(self, websocket: ServerConnection) -> None:
        host, port, *_ = websocket.remote_address or ("nobody", 0)
        self.name = f"{host}:{port}"
        self._websocket = websocket
        self._outbox = Outbox()
        self._filled = asyncio.Event()
        self._sending_since: float | None = None
        self._given_up = False
        self._socket = websocket.transport.get_extra_info("socket")
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)

    def reply(self, text: str) -> None:
        if not self._send_now(text):
            self._outbox.reply(text)
            self._wait()

    def message(self, topic: str, text: str, queue_length: int) -> None:
        """A message of a topic; while the client is slow, the newest `queue_length` are kept."""
        if not self._send_now(text):
            self._outbox.message(topic, text, queue_length)
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
                    await self._websocket.send(self._outbox.next())
                self._sending_since = None

    def _send_now(self, text: str) -> bool:
        """Send without a detour by the outbox, unless something is before it."""
        if self._outbox or self._websocket.transport.get_write_buffer_size():
            return False
        broadcast((self._websocket,), text)
        return True

    def _wait(self) -> None:
        self._filled.set()
        if self._outbox.is_full:
            self._give_up("it does not read what it has asked for")

    def _give_up(self, reason: str) -> None:
        if self._given_up:  # messages still come until the end of the socket has reached the bridge
            return
        self._given_up = True
        _log.warning("%s: given up, %s", self.name, reason)
        # reset the connection: the kernel shall not go on with what it still holds for this client
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self._websocket.transport.abort()
