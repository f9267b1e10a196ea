"""waitress with fair shares: whoever opens sockets and says nothing cannot lock the others out.

waitress takes no connection while all its places are in use, and forgets a silent one after minutes. Here a newcomer
always gets a place: an address that has more than its share, or the one that has the most when all are taken, loses the
one of them that has waited longest for a complete request. A request that is not complete in time is not waited for.
Proxies have places of their own: they share them out among their visitors.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any
from wsgiref.types import WSGIApplication

from waitress.adjustments import Adjustments
from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser, ParsingError
from waitress.server import TcpWSGIServer
from waitress.task import WSGITask

from laser_bot_battle.listening import Listener
from laser_bot_battle.open_files import allow_files
from laser_bot_battle.proxies import FORWARDED, THIS_MACHINE, Network, is_proxy, visitor
from server.web.lanes import Lane, Lanes, Task
from server.web.turns import Turns

PLACES, PROXIED = 500, 1500  # connections of visitors themselves, and of proxies; the front holds slow visitors back
SHARE = 100  # of one address that is no proxy
REQUEST_WITHIN = 10.0  # s from the first byte, or from the connection, to the whole request
_IDLE = 30  # s without a further request
_AT_ONCE = 50  # connections that are taken in a turn of the loop
_SPARE = 50  # connections that are just being closed
_FILES = 200  # of all else in this process
_FORWARDED = FORWARDED.upper().replace("-", "_")  # as waitress calls it


class _Parser(HTTPRequestParser):  # type: ignore[misc]
    def parse_header(self, header_plus: bytes) -> None:
        """As ever; what Python itself cannot read, such as a length of 5000 digits, is a bad request too."""
        try:
            super().parse_header(header_plus)
        except ValueError as error:
            raise ParsingError("the header cannot be understood") from error

    def received(self, data: bytes) -> int:
        consumed: int = super().received(data)
        if self.completed:
            # to ask for more, waitress would mark it as incomplete again, and then wait for a body that never comes
            self.expect_continue = False
        return consumed


class _Task(WSGITask):  # type: ignore[misc]
    def service(self) -> None:
        """As ever; the server gets to know what was refused."""
        try:
            super().service()
        finally:
            if self.status.startswith("4"):
                self.channel.server.refused(self.channel)


class _Channel(HTTPChannel):  # type: ignore[misc]
    """A connection. `waits_since`: since when the server has waited for a request; monotonic s, as all times here."""

    parser_class = _Parser
    task_class = _Task

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.waits_since = time.monotonic()
        self._begun_at: float | None = self.waits_since
        self._asked, self._answered = 0, 0  # requests, counted while they are locked
        super().__init__(*arguments, **options)

    @property
    def address(self) -> str:
        return str(self.addr[0])

    @property
    def file(self) -> int | None:
        """None: it is closed."""
        file: int | None = self._fileno
        return file

    def add_channel(self, map: dict[int, Any] | None = None) -> None:  # noqa: A002 - waitress' name
        super().add_channel(map)
        self.server.turns.stir(self.file)

    def del_channel(self, map: dict[int, Any] | None = None) -> None:  # noqa: A002 - waitress' name
        self.server.turns.leave(self.file)
        super().del_channel(map)
        self.server.forget(self)

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
        with self.requests_lock:
            self._answered += 1

    def is_asked(self) -> None:
        """A worker will answer, and then has no more to do with it."""
        self._asked += 1

    @property
    def rests(self) -> bool:
        """No worker changes it."""
        return self._asked == self._answered

    def is_late(self, now: float) -> bool:
        """Its request is not complete, and should be."""
        return self.is_idle and self._begun_at is not None and now - self._begun_at > REQUEST_WITHIN


class FairServer(TcpWSGIServer):  # type: ignore[misc]
    """Serves `application` on `listener`, which is bound, once `run` is called. `channels` is waitress' map of all that
    the loop looks after; `lane` says which lane a request is in, by its method and path."""

    channel_class = _Channel

    def __init__(
        self,
        application: WSGIApplication,
        listener: Listener,
        channels: dict[int, Any],
        lane: Callable[[str, str], Lane],
        proxies: Sequence[Network] = (),
    ) -> None:
        adjustments = Adjustments(
            connection_limit=PLACES + PROXIED + _SPARE,
            channel_timeout=_IDLE,
            cleanup_interval=1,
            max_request_header_size=1 << 15,  # of each place, in memory
            max_request_body_size=1 << 20,  # what the application then refuses politely
            clear_untrusted_proxy_headers=False,  # the application knows which proxies are believed
            log_socket_errors=False,  # a visitor who goes away is no failure of ours
        )
        self._lane, self._proxies = lane, proxies
        self._visitors, self._proxied = _Places(PLACES, SHARE), _Places(PROXIED, PROXIED)
        self._has_come = False
        self.turns = Turns(channels, lambda member: isinstance(member, _Channel) and member.rests)
        allow_files(PLACES + PROXIED + _SPARE + _FILES)
        super().__init__(
            application,
            channels,
            _sock=listener,
            dispatcher=Lanes(self._place),
            adj=adjustments,
            sockinfo=(listener.family, listener.type, listener.proto, listener.getsockname()),
            bind_socket=False,
        )

    def run(self) -> None:
        self.turns.run(self.adj.asyncore_loop_timeout)

    def add_task(self, task: Task) -> None:
        if isinstance(task, _Channel):
            task.is_asked()
        super().add_task(task)

    def refused(self, channel: _Channel) -> None:
        """What it asks for just now."""
        self.task_dispatcher.refused(*self._place(channel))

    def accept(self) -> Any:
        accepted = super().accept()
        self._has_come = accepted is not None
        return accepted

    def handle_accept(self) -> None:
        for _ in range(_AT_ONCE):
            self._has_come = False
            super().handle_accept()
            if not self._has_come:
                return
            newcomer = next(reversed(self.active_channels.values()))
            self._places_of(newcomer).take(newcomer)

    def forget(self, channel: _Channel) -> None:
        """It is closed."""
        self._places_of(channel).leave(channel)

    def _places_of(self, channel: _Channel) -> "_Places":
        return self._proxied if is_proxy(channel.address, self._proxies) else self._visitors

    def _place(self, task: Task) -> tuple[Lane, str | None]:
        """Which lane it is in, and whose it is; None: this machine's."""
        if not isinstance(task, _Channel):
            return Lane.ROBOTS, None  # the program's own
        asked = task.requests[0]
        forwarded = asked.headers.get(_FORWARDED)
        owner = visitor(task.address, forwarded, self._proxies)
        lane = Lane.PAGES if asked.error else self._lane(asked.command, asked.path)
        return lane, None if forwarded is None and owner in THIS_MACHINE else owner

    def maintenance(self, now: float) -> None:
        super().maintenance(now)
        self.close_late(time.monotonic())

    def close_late(self, now: float) -> None:
        for channel in list(self.active_channels.values()):
            if channel.is_late(now):
                channel.will_close = True
            if channel.will_close:
                self.turns.stir(channel.file)


class _Places:
    """So many connections there may be, and so many of one address."""

    def __init__(self, places: int, share: int) -> None:
        self._limit, self._share = places, share
        self._channels_of: dict[str, dict[_Channel, None]] = {}  # by address
        self._taken = 0

    def take(self, newcomer: _Channel) -> None:
        """Another one may have to go."""
        address = newcomer.address
        others = self._channels_of.setdefault(address, {})
        self._taken += newcomer not in others
        others[newcomer] = None
        if self._taken > self._limit:
            address = max(self._channels_of, key=lambda one: len(self._channels_of[one]))
        elif len(self._channels_of[address]) <= self._share:
            return
        min(self._channels_of[address], key=lambda one: (not one.is_idle, one.waits_since)).handle_close()

    def leave(self, channel: _Channel) -> None:
        """It is closed; once more changes nothing."""
        others = self._channels_of.get(channel.address, {})
        if channel in others:
            del others[channel]
            self._taken -= 1
        if not others:
            self._channels_of.pop(channel.address, None)
