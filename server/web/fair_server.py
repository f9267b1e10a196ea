"""waitress with fair shares: whoever opens sockets and says nothing cannot lock the others out.

waitress takes no connection while all its places are in use, and forgets a silent one after minutes. Here a newcomer
always gets a place: when all are taken, the address that has the most loses the one of them that has waited longest
for a complete request. A request that is not complete in time is not waited for.
"""

import socket
import time
from collections import Counter
from typing import Any
from wsgiref.types import WSGIApplication

from waitress.adjustments import Adjustments
from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser, ParsingError
from waitress.server import TcpWSGIServer
from waitress.task import ThreadedTaskDispatcher

PLACES = 500  # connections
REQUEST_WITHIN = 10.0  # s from the first byte, or from the connection, to the whole request
_IDLE = 30  # s without a further request
_SPARE = 50  # files of waitress' own, and connections that are just being closed
_THREADS = 8


class _Parser(HTTPRequestParser):  # type: ignore[misc]
    def parse_header(self, header_plus: bytes) -> None:
        """As ever; what Python itself cannot read, such as a length of 5000 digits, is a bad request too."""
        try:
            super().parse_header(header_plus)
        except ValueError as error:
            raise ParsingError("the header cannot be understood") from error


class _Channel(HTTPChannel):  # type: ignore[misc]
    """A connection. `waits_since`: since when the server has waited for a request; monotonic s, as all times here."""

    parser_class = _Parser

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.waits_since = time.monotonic()
        self._begun_at: float | None = self.waits_since
        super().__init__(*arguments, **options)

    @property
    def address(self) -> str:
        return str(self.addr[0])

    @property
    def is_idle(self) -> bool:
        """No request is being answered."""
        return not self.requests

    def received(self, data: bytes) -> bool:
        if self._begun_at is None:
            self._begun_at = time.monotonic()
        going_on: bool = super().received(data)
        if self.request is None:
            self._begun_at = None
        return going_on

    def service(self) -> None:
        super().service()
        self.waits_since = time.monotonic()

    def is_late(self, now: float) -> bool:
        """Its request is not complete, and should be."""
        return self.is_idle and self._begun_at is not None and now - self._begun_at > REQUEST_WITHIN


class FairServer(TcpWSGIServer):  # type: ignore[misc]
    """Serves `application` on `listener`, a bound socket, once `run` is called. `channels` is waitress' map of all that
    the loop looks after."""

    channel_class = _Channel

    def __init__(self, application: WSGIApplication, listener: socket.socket, channels: dict[int, Any]) -> None:
        adjustments = Adjustments(
            threads=_THREADS,
            connection_limit=PLACES + _SPARE,
            channel_timeout=_IDLE,
            cleanup_interval=1,
            asyncore_use_poll=True,  # select() ends at 1024 files
            max_request_header_size=1 << 15,  # of each place, in memory
            max_request_body_size=1 << 20,  # what the application then refuses politely
            clear_untrusted_proxy_headers=False,  # the application knows which proxies are believed
            log_socket_errors=False,  # a visitor who goes away is no failure of ours
        )
        workers = ThreadedTaskDispatcher()
        workers.set_thread_count(_THREADS)
        super().__init__(
            application,
            channels,
            _sock=listener,
            dispatcher=workers,
            adj=adjustments,
            sockinfo=(listener.family, listener.type, listener.proto, listener.getsockname()),
            bind_socket=False,
        )

    def handle_accept(self) -> None:
        super().handle_accept()
        if len(self.active_channels) > PLACES:
            loser = whose_place(list(self.active_channels.values()))
            if loser is not None:
                loser.handle_close()

    def maintenance(self, now: float) -> None:
        super().maintenance(now)
        self.close_late(time.monotonic())

    def close_late(self, now: float) -> None:
        for channel in list(self.active_channels.values()):
            if channel.is_late(now):
                channel.will_close = True


def whose_place(channels: list[_Channel]) -> _Channel | None:
    """Who makes room for a newcomer; None when all are being answered."""
    taken = Counter(channel.address for channel in channels)

    def claim(channel: _Channel) -> tuple[int, float]:
        return -taken[channel.address], channel.waits_since

    return min((channel for channel in channels if channel.is_idle), key=claim, default=None)
