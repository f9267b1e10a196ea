"""What all sockets of one server share."""

import asyncio
import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from laser_bot_battle.openings import Openings
from laser_bot_battle.proxies import Network
from server.access.identity import Identity
from server.websocket.limits import SocketLimits, SocketOwner
from server.websocket.scheduling import Scheduler

_log = logging.getLogger(__name__)

# What is read of one socket in one turn.
READ = 16 * 2**10  # bytes
# Guests who come and go must not fill the operator's log, and one of them must not hide all others.
MAX_LOG_LINES = 50  # a second
MAX_LINES_OF_ADDRESS = 20  # a second


class Connection(Protocol):
    """A client's WebSocket, as the server looks after it."""

    def check(self, now: float) -> None:
        """To be called twice a second: is it alive, and does it read?"""

    def extend_deadlines(self, seconds: float) -> None:
        """The loop stood still for so long."""

    def close(self, code: int, reason: str = "") -> None:
        """Tell the client, and hear nothing more of it."""


class Bridge(Protocol):
    """What the server needs of whom it serves. A client is whatever the bridge makes of a connection."""

    def owner(self, identity: Identity, address: str) -> SocketOwner:
        """Who owns a socket of this identity, as far as is known now."""

    def connected(self, connection: Any, identity: Identity) -> Any:
        """Returns the client."""

    def received(self, client: Any, data: str | bytes) -> None:
        """A message."""

    def disconnected(self, client: Any) -> None:
        """Nothing more is received, and what is sent is dropped."""


@dataclass(eq=False)
class ServerState:
    """For the event loop's thread only."""

    loop: asyncio.AbstractEventLoop
    bridge: Bridge
    sockets: SocketLimits
    scheduler: Scheduler
    openings: Openings
    proxies: Sequence[Network] = ()  # that say for whom they come
    connections: set[Connection] = field(default_factory=set)
    # every socket is read into this: what a message leaves there is copied before the next is read
    scratch: memoryview = field(default_factory=lambda: memoryview(bytearray(READ)))
    ending: bool = False  # nobody is let in any more
    empty: asyncio.Event = field(default_factory=asyncio.Event)  # nobody is left
    _lines: Counter[str] = field(default_factory=Counter, init=False)  # by address, that were written
    _lines_left_out: int = field(default=0, init=False)
    _lines_since: float = field(default=float("-inf"), init=False)

    def left(self) -> None:
        """One of the openings or connections has gone."""
        if self.ending and not self.openings and not self.connections:
            self.empty.set()

    def log(self, address: str, text: str, level: int = logging.INFO) -> None:
        """A line about a client of this address, unless there have been too many of late."""
        if not _log.isEnabledFor(level):
            return
        now = self.loop.time()
        if now - self._lines_since >= 1:
            if self._lines_left_out:
                _log.info("%d lines about clients were left out", self._lines_left_out)
            self._lines.clear()
            self._lines_left_out, self._lines_since = 0, now
        if self._lines[address] >= MAX_LINES_OF_ADDRESS or self._lines.total() >= MAX_LOG_LINES:
            self._lines_left_out += 1
            return
        self._lines[address] += 1
        _log.log(level, "%s", text)
