"""The TCP connections to the arena's page: each address may have some, and none may be silent."""

import asyncio
from collections import Counter
from collections.abc import Callable, Sequence
from typing import cast

from laser_bot_battle.listening import addresses
from laser_bot_battle.openings import MOST, OF_ADDRESS, OPEN_TIMEOUT, Openings
from laser_bot_battle.plain_address import plain_address
from laser_bot_battle.proxies import Network, is_proxy
from sim.arena.view import MAX_VIEWERS

TICK = 0.5  # s between two looks at who is silent
BACKLOG = 256  # connections that the kernel holds until they are accepted
MAX_HEAD = 16 * 2**10  # bytes of a request before it is given to the page, which has bounds of its own
END_OF_HEAD = b"\r\n\r\n"
ALL = MAX_VIEWERS + MOST  # connections
OF_ONE = 2 * OF_ADDRESS  # of one address that is no proxy: the viewers that it may have, and as many others


class Visits:
    """Listens, and gives each connection to `page` as soon as it has sent the whole head of a request."""

    def __init__(self, page: Callable[[], asyncio.Protocol], proxies: Sequence[Network]) -> None:
        self.page = page
        self.proxies = proxies
        self.openings = Openings()
        self.taken: Counter[str] = Counter()  # connections by address
        self._server: asyncio.Server | None = None
        self._timer: asyncio.TimerHandle | None = None

    async def start(self, bind: str, port: int) -> None:
        """OSError if the port cannot be had."""
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(lambda: _Visit(self), addresses(bind), port, backlog=BACKLOG)
        self._tick()

    def stop(self) -> None:
        """Nobody new is let in, and who has not said what they want is cut."""
        if self._timer:
            self._timer.cancel()
        if self._server:
            self._server.close()
        for opening in self.openings:
            opening.cut()

    def _tick(self) -> None:
        loop = asyncio.get_running_loop()
        self.openings.cut_older(loop.time() - OPEN_TIMEOUT)
        self._timer = loop.call_later(TICK, self._tick)


class _Visit(asyncio.Protocol):
    """One connection."""

    def __init__(self, visits: Visits) -> None:
        self._visits = visits
        self._head = b""
        self._page: asyncio.Protocol | None = None
        self._transport: asyncio.Transport
        self.address = ""

    def cut(self) -> None:
        self._transport.abort()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)
        address, *_ = transport.get_extra_info("peername") or ("nobody",)
        self.address = plain_address(address)
        visits = self._visits
        is_many = is_proxy(self.address, visits.proxies)
        visits.taken[self.address] += 1
        has_room = visits.taken.total() <= ALL and (is_many or visits.taken[self.address] <= OF_ONE)
        if not visits.openings.add(self, asyncio.get_running_loop().time(), is_many=is_many) or not has_room:
            self.cut()

    def data_received(self, data: bytes) -> None:
        if self._page:
            self._page.data_received(data)
            return
        self._head += data
        if END_OF_HEAD in self._head or len(self._head) > MAX_HEAD:
            self._visits.openings.remove(self)
            self._page = self._visits.page()
            self._page.connection_made(self._transport)
            self._page.data_received(self._head)

    def eof_received(self) -> bool | None:
        return self._page.eof_received() if self._page else False

    def pause_writing(self) -> None:
        if self._page:
            self._page.pause_writing()

    def resume_writing(self) -> None:
        if self._page:
            self._page.resume_writing()

    def connection_lost(self, error: Exception | None) -> None:
        self._visits.openings.remove(self)
        self._visits.taken[self.address] -= 1
        if not self._visits.taken[self.address]:
            del self._visits.taken[self.address]
        if self._page:
            self._page.connection_lost(error)
