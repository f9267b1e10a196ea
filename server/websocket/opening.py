"""The opening handshake (RFC 6455, 4): from a TCP connection to a client, or to a refusal."""

import asyncio
import email.utils
import logging
from collections.abc import Callable
from functools import partial
from http import HTTPStatus
from typing import cast

from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.server import ServerProtocol

from laser_bot_battle import subprotocols
from laser_bot_battle.plain_address import plain_address
from laser_bot_battle.proxies import FORWARDED, asked, is_proxy, visitor
from server.access.identity import Identity
from server.websocket.connection import Connection
from server.websocket.server_state import ServerState

MAX_HEAD = 16 * 2**10  # bytes; a page's cookies for this host are in it
END_OF_HEAD = b"\r\n\r\n"
NO_HANDSHAKE = "this is no HTTP request that a WebSocket begins with\n"

# By Origin, by what the visitor took for Host, and by all Cookie headers.
Identify = Callable[[str | None, str | None, list[str]], Identity]

_log = logging.getLogger(__name__)

# The library's own lines: nothing that a client sends is worth a traceback.
_silent = logging.Logger("websockets", logging.CRITICAL + 1)


class Opening(asyncio.BufferedProtocol):
    """One TCP connection until its handshake is finished."""

    def __init__(self, state: ServerState, identify: Identify) -> None:
        self._state, self._identify = state, identify
        self._head = bytearray()
        self._transport: asyncio.Transport
        self._answered = False
        self.address = ""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)  # uvloop's are no subclass
        address, *_ = transport.get_extra_info("peername") or ("nobody",)
        self.address = plain_address(address)
        # a proxy's address does not say yet who comes
        is_many = is_proxy(self.address, self._state.proxies)
        may_stay = self._state.openings.add(self, self._state.loop.time(), is_many=is_many)
        if self._state.ending or not may_stay:
            self.cut()

    def get_buffer(self, sizehint: int) -> memoryview:
        return self._state.scratch

    def buffer_updated(self, count: int) -> None:
        searched = max(0, len(self._head) - len(END_OF_HEAD))
        self._head += self._state.scratch[:count]
        if END_OF_HEAD in self._head[searched:] or len(self._head) > MAX_HEAD:
            self._transport.pause_reading()
            if self._state.scheduler.run(self, urgent=False):
                self.resume()
            else:
                self._state.scheduler.wait(self)

    def work(self) -> bool:
        """Answer the request."""
        if not self._answered:
            self._answered = True
            head, end, rest = self._head.partition(END_OF_HEAD)
            try:
                self._answer(bytes(head + end), bytes(rest))
            except Exception:  # this client's handshake, and nobody else's trouble
                _log.exception("a handshake of %s could not be answered", self.address)
                self.cut()
        return True

    def resume(self) -> None:
        self._transport.resume_reading()

    def cut(self) -> None:
        self._answered = True
        self._transport.abort()

    def connection_lost(self, error: Exception | None) -> None:
        self._state.openings.remove(self)
        self._state.left()

    def _answer(self, head: bytes, rest: bytes) -> None:
        protocol = ServerProtocol(logger=_silent)
        protocol.receive_data(head)
        request = next(iter(protocol.events_received()), None)
        if not isinstance(request, Request):
            self._refuse(plain(HTTPStatus.BAD_REQUEST, NO_HANDSHAKE))
            return
        if [upgrade.lower() for upgrade in request.headers.get_all("Upgrade")] != ["websocket"]:
            # whoever asks whether this is alive gets the same answer when there is no room for a client
            response = plain(HTTPStatus.UPGRADE_REQUIRED, "this is a WebSocket server\n")
            response.headers["Upgrade"] = "websocket"
            del response.headers["Connection"]
            response.headers["Connection"] = "Upgrade, close"  # RFC 9110 7.8 wants it with every Upgrade
            self._refuse(response)
            return
        offers = request.headers.get_all(subprotocols.HEADER)
        if offers:
            del request.headers[subprotocols.HEADER]  # the library refuses one that is not written well
        response = protocol.accept(request)
        if response.status_code == HTTPStatus.INTERNAL_SERVER_ERROR:  # headers that the library cannot read
            response = plain(HTTPStatus.BAD_REQUEST, NO_HANDSHAKE)
        if response.status_code != HTTPStatus.SWITCHING_PROTOCOLS:
            self._refuse(response)
            return
        if subprotocol := subprotocols.chosen(offers):
            response.headers[subprotocols.HEADER] = subprotocol
        self._enter(request.headers, response, rest)

    def _enter(self, headers: Headers, response: Response, rest: bytes) -> None:
        authority = asked(self.address, partial(only, headers), self._state.proxies).authority
        self.address = visitor(self.address, only(headers, FORWARDED), self._state.proxies)
        origin = only(headers, "Origin")
        identity = self._identify(origin, authority, headers.get_all("Cookie"))
        if identity.foreign:
            self._state.log(
                self.address,
                f"the page of {self.address} belongs to another web site: it comes from {origin!r:.100} and asked for "
                f"{authority!r:.100}. If it belongs to the game, behind a proxy, name its address in LASERBOT_ORIGINS",
            )
        owner = self._state.bridge.owner(identity, self.address)
        if reason := self._state.sockets.refusal(owner):
            self._state.log(self.address, f"a client of {self.address} was refused: {reason}")
            self._refuse(plain(HTTPStatus.SERVICE_UNAVAILABLE, "too many clients\n"))
            return
        self._state.openings.remove(self)
        self._transport.write(response.serialize())
        connection = Connection(self._state, self._transport, self.address, owner)
        self._transport.set_protocol(connection)
        connection.begin(identity, rest)

    def _refuse(self, response: Response) -> None:
        self._transport.write(response.serialize())
        self._transport.close()


def plain(status: HTTPStatus, text: str) -> Response:
    """An answer in words, after which the connection ends."""
    body = text.encode()
    headers = Headers(
        {
            "Date": email.utils.formatdate(usegmt=True),
            "Connection": "close",
            "Content-Length": str(len(body)),
            "Content-Type": "text/plain; charset=utf-8",
        }
    )
    return Response(status.value, status.phrase, headers, body)


def only(headers: Headers, name: str) -> str | None:
    """The header's value, None without one. Of several no browser's is made: together they are nobody's address."""
    return ", ".join(headers.get_all(name)) or None
