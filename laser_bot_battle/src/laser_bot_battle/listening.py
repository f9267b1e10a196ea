"""Sockets that listen by IPv4 and by IPv6: whoever connects to `localhost` may try only one of them.

Each family has a socket of its own, so clients by IPv4 keep their addresses.
"""

import contextlib
import errno
import select
import socket
from collections import deque
from collections.abc import Iterator
from functools import cached_property
from types import TracebackType
from typing import Any, Self

from laser_bot_battle.plain_address import plain_address

# everywhere, and on this machine only: each in the other family, too
_OTHER = {"0.0.0.0": "::", "::": "0.0.0.0", "127.0.0.1": "::1", "::1": "127.0.0.1"}
_TRIES = 20  # to find a port that is free in both families

_Place = tuple[socket.AddressFamily, tuple[Any, ...]]  # a family, and an address as it has them


class Listener:
    """Sockets at one port, used as if they were one socket that listens. A context manager that closes them."""

    def __init__(self, *sockets: socket.socket) -> None:
        """They are bound, and not listening yet."""
        self.sockets = sockets
        for each in sockets:
            each.setblocking(False)
        self._turns = deque(sockets)  # nobody waits for ever while many come by the other family
        self._waits = True
        self.family, self.type, self.proto = sockets[0].family, sockets[0].type, sockets[0].proto

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        self.close()

    @cached_property
    def _ready(self) -> select.epoll:
        ready = select.epoll()
        for each in self.sockets:
            ready.register(each, select.EPOLLIN)
        return ready

    def fileno(self) -> int:
        """Can be read when a client waits; not before `listen`."""
        return self._ready.fileno()

    def listen(self, backlog: int) -> None:
        for each in self.sockets:
            each.listen(backlog)

    def accept(self) -> tuple[socket.socket, tuple[Any, ...]]:
        """A client's connection, and where it comes from. BlockingIOError when none is there, or waited for."""
        while True:
            for _ in self.sockets:
                self._turns.rotate()
                with contextlib.suppress(BlockingIOError):
                    client, (address, *more) = self._turns[0].accept()
                    return client, (plain_address(address), *more)
            if not self._waits:
                raise BlockingIOError(errno.EAGAIN, "no client waits")
            self._ready.poll()

    def setblocking(self, waits: bool) -> None:
        """Whether `accept` waits for a client."""
        self._waits = bool(waits)

    def getsockname(self) -> Any:
        """Of one of them; all have its port."""
        return self.sockets[0].getsockname()

    def getpeername(self) -> Any:
        """OSError: nobody is at the other end."""
        return self.sockets[0].getpeername()

    def getsockopt(self, level: int, name: int) -> int:
        return self.sockets[0].getsockopt(level, name)

    def setsockopt(self, level: int, name: int, value: int) -> None:
        for each in self.sockets:
            each.setsockopt(level, name, value)

    def close(self) -> None:
        for each in self.sockets:
            each.close()
        if "_ready" in vars(self):
            self._ready.close()


def addresses(bind: str) -> list[str]:
    """Where to listen for `bind`, an address or a host's name: at all that it means, in both families if that is
    everywhere or this machine only. What this machine has not, such as IPv6, is left out, unless nothing else is left.

    OSError: nobody knows the name.
    """
    return [str(place[0]) for _, place in _places(bind)]


def bind(address: str, port: int) -> Listener:
    """Sockets that are bound at all `addresses` of `address`, not listening yet. Port 0: one that is free in all.

    OSError if the port cannot be had.
    """
    places = _places(address)
    for attempt in range(_TRIES):
        with contextlib.ExitStack() as undo:
            try:
                sockets = [undo.enter_context(each) for each in _bound(places, port)]
            except OSError as error:
                if port or error.errno != errno.EADDRINUSE or attempt == _TRIES - 1:
                    raise
            else:
                undo.pop_all()
                return Listener(*sockets)
    raise AssertionError("the last attempt has told")


def _bound(places: list[_Place], port: int) -> Iterator[socket.socket]:
    for place in places:
        each = _socket(place, port)
        port = each.getsockname()[1]
        yield each


def _socket(place: _Place, port: int) -> socket.socket:
    family, (address, _, *more) = place
    bound = socket.socket(family, socket.SOCK_STREAM)
    try:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            bound.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        bound.bind((address, port, *more))
    except OSError:
        bound.close()
        raise
    return bound


def _places(bind: str) -> list[_Place]:
    """Those of IPv4 first."""
    meant = _resolved(plain_address(bind))
    meant += [other for _, place in meant if place[0] in _OTHER for other in _resolved(_OTHER[place[0]])]
    meant = sorted(dict.fromkeys(meant), key=lambda place: place[0] != socket.AF_INET)
    return [place for place in meant if _is_here(place)] or meant[:1]


def _resolved(host: str) -> list[_Place]:
    try:
        found = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    except UnicodeError:
        raise OSError("that is no host's name") from None
    return [(family, place) for family, *_, place in found]


def _is_here(place: _Place) -> bool:
    try:
        _socket(place, 0).close()
    except OSError:
        return False
    return True
