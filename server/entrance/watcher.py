"""Asks each arena how it is, again and again: beside one another, so that one that is slow, silent or endless holds up
no other. Those that are away are asked in turns of their own, and less often the longer they are."""

import asyncio
import logging
import math
import socket
import ssl
import threading
from collections.abc import Callable, Sequence
from functools import cache
from urllib.parse import SplitResult, urlsplit

from laser_bot_battle.arena_list import ListedArena
from laser_bot_battle.backoff import Backoff
from server.entrance.arenas import FRESH
from server.entrance.lookups import LookUp, Lookups
from server.entrance.seen import MAX_SIZE, Seen, read_seen

PERIOD = 2.0  # s between two questions to an arena
WITHIN = 2.0  # s for a whole answer
SELDOM = 20.0  # s between two questions to one that is away, at most
_AT_ONCE = 50  # questions to those that answer, and as many to others
_PATH = "/watch.json"
_MAX_HEAD = 16 * 1024  # bytes

_log = logging.getLogger(__name__)


async def ask(origin: str, lookups: Lookups, within: float = WITHIN) -> Seen:
    """How the arena at `origin` (http://host:port) is. OSError (TimeoutError among them) or ValueError: it cannot be
    known."""
    url = urlsplit(origin)
    async with asyncio.timeout(within):
        reader, writer = await _connect(url, lookups)
        try:
            # by HTTP/1.0 the answer ends with the connection: there is no framing to be cheated with
            writer.write(f"GET {_PATH} HTTP/1.0\r\nHost: {url.netloc}\r\nAccept: application/json\r\n\r\n".encode())
            return read_seen(_body(await _all(reader)))
        finally:
            writer.transport.abort()  # whoever does not close it does not keep it


async def _connect(url: SplitResult, lookups: Lookups) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """To the first of its addresses that takes it."""
    host, is_secure = url.hostname or "", url.scheme == "https"
    port = url.port or (443 if is_secure else 80)
    trust, name = (_trust(), host) if is_secure else (None, None)
    failure = OSError(f"{host} has no address")
    for address in await lookups.addresses(host, port):
        try:
            return await asyncio.open_connection(address, port, ssl=trust, server_hostname=name)
        except OSError as error:
            failure = error
    raise failure


@cache
def _trust() -> ssl.SSLContext:
    """The authorities that this machine trusts; to read them takes longer than an answer."""
    return ssl.create_default_context()


async def _all(reader: asyncio.StreamReader) -> bytes:
    found = b""
    while piece := await reader.read(1 << 16):
        found += piece
        if len(found) > MAX_SIZE + _MAX_HEAD:
            raise ValueError(f"its answer has more than {MAX_SIZE} bytes")
    return found


def _body(answer: bytes) -> bytes:
    head, _, body = answer.partition(b"\r\n\r\n")
    status = head.partition(b"\r\n")[0].split(b" ")
    if len(status) < 2 or not status[0].startswith(b"HTTP/1.") or status[1] != b"200":
        raise ValueError(f"it answers {head[:60]!r}")
    return body


class Watcher:
    """Tells `hear` what the arena of a name has said."""

    def __init__(
        self,
        arenas: Sequence[ListedArena],
        hear: Callable[[str, Seen], None],
        look_up: LookUp = socket.getaddrinfo,
    ) -> None:
        self._arenas, self._hear = arenas, hear
        self._lookups = Lookups(look_up)
        self._away: dict[str, str] = {}  # why, by name
        self._ending = threading.Event()

    def run(self) -> None:
        """Until `stop`. For a thread of its own."""
        asyncio.run(self._watch())

    def stop(self) -> None:
        self._ending.set()

    async def _watch(self) -> None:
        here, away = asyncio.Semaphore(_AT_ONCE), asyncio.Semaphore(_AT_ONCE)
        async with asyncio.TaskGroup() as group:
            for place, arena in enumerate(self._arenas):
                group.create_task(self._follow(arena, PERIOD * place / len(self._arenas), here, away))

    async def _follow(self, arena: ListedArena, first: float, here: asyncio.Semaphore, away: asyncio.Semaphore) -> None:
        await asyncio.sleep(first)  # not all at the same moment
        clock, heard_at, backoff = asyncio.get_running_loop().time, -math.inf, Backoff(SELDOM)
        while not self._ending.is_set():
            async with here if clock() - heard_at < FRESH else away:
                is_heard = await self._ask(arena)
            if is_heard:
                heard_at = clock()
                backoff.worked()
            await asyncio.sleep(PERIOD if is_heard else max(PERIOD, backoff.failed()))

    async def _ask(self, arena: ListedArena) -> bool:
        """Whether it has answered."""
        try:
            seen = await ask(arena.inside, self._lookups, WITHIN)
        except (OSError, ValueError) as error:
            reason = str(error) or f"no whole answer within {WITHIN:g} s"
            if arena.name not in self._away:
                _log.warning("%s at %s is away: %s", arena.name, arena.inside, reason)
            self._away[arena.name] = reason
            return False
        if self._away.pop(arena.name, None):
            _log.info("%s at %s is back", arena.name, arena.inside)
        self._hear(arena.name, seen)
        return True
