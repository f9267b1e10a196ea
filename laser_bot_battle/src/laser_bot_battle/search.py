"""Looking for arenas in the network, with zeroconf. What is heard is anybody's word: it is bounded, and tried out."""

import asyncio
import contextlib
import ipaddress
import logging
import time
from collections.abc import AsyncIterator, Iterable

from zeroconf import BadTypeInNameException, IPVersion, ServiceStateChange, Zeroconf
from zeroconf.asyncio import AsyncServiceBrowser, AsyncServiceInfo, AsyncZeroconf

from laser_bot_battle.addresses import lan_addresses, without_network
from laser_bot_battle.announcement import SERVICE, Announcement, NoArenaError, UnheardError, arena_of, choose, read
from laser_bot_battle.master_probe import is_master

# s until all have answered. The first answer often goes to another program at port 5353 of this machine, if there is
# one; the second question comes after 1 s, and one that has just spoken may wait for 1 s more (RFC 6762, section 6).
LISTEN = 2.5
RESOLVE = 1.2  # s for the records of one service: LISTEN is to see the end of it
ROUND = 10.0  # s after which a long search starts anew: this machine's networks may have changed
PAUSE = 0.3  # s between two looks of a long search
MAX_ARENAS = 64  # that are looked at
MAX_RECORDS = 10_000  # of all kinds, from everybody
MAX_CLAIMS = 4  # places that are announced under one name, and tried: a false one does not hide the true one
MAX_REASONS = 3  # that are told in one line


class Search:
    """The arenas that announce themselves, while `searching` is open.

    `wanted` is the name of the one that matters, or "": however many there are, it is looked at.
    """

    def __init__(self, zeroconf: Zeroconf, wanted: str) -> None:
        self._zeroconf = zeroconf
        self._wanted = wanted.casefold()
        self.announced: dict[str, list[Announcement]] = {}  # by the service's name; the newest at the end
        self.refused: dict[str, str] = {}  # why, by the service's name
        self.ignored = 0  # announcements beyond MAX_ARENAS
        self.news = asyncio.Event()
        self._asking: dict[str, asyncio.Task[None]] = {}

    def heard(self, zeroconf: Zeroconf, service_type: str, name: str, state_change: ServiceStateChange) -> None:
        """Called by zeroconf, in the loop."""
        if state_change is ServiceStateChange.Removed:
            self._forget(name)
        elif state_change is ServiceStateChange.Updated and name not in self._asking:
            return  # an answer that was on its way when the arena was withdrawn
        elif name in self._asking or len(self._asking) < MAX_ARENAS or arena_of(name).casefold() == self._wanted:
            self._ask(name)
        else:
            self.ignored += 1

    def is_flooded(self) -> bool:
        """Whether so much was heard that it is time to forget it: zeroconf itself keeps everything."""
        return sum(map(len, self._zeroconf.cache.cache.values())) > MAX_RECORDS

    def all(self) -> list[Announcement]:
        return [announcement for claims in self.announced.values() for announcement in claims]

    def named(self, arena: str) -> list[Announcement]:
        """What is announced under that name."""
        return [one for one in self.all() if one.arena.casefold() == arena.casefold()]

    def passed_over(self) -> str:
        """What was not taken and why, to be added to a line; "" if there was nothing."""
        reasons = [f"{arena_of(name)!r}, because {reason}" for name, reason in self.refused.items()]
        more = max(0, len(reasons) - MAX_REASONS) + self.ignored
        text = "; ".join(reasons[:MAX_REASONS]) + (f"; and {more} more" if more else "")
        return f" (passed over: {text})" if reasons else ""

    async def close(self) -> None:
        """End what is being asked."""
        tasks = list(self._asking.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _ask(self, name: str) -> None:
        before = self._asking.get(name)
        if before:
            before.cancel()
        self._asking[name] = asyncio.ensure_future(self._resolve(name))

    def _forget(self, name: str) -> None:
        task = self._asking.pop(name, None)
        if task:
            task.cancel()
        self.announced.pop(name, None)
        self.refused.pop(name, None)
        self.news.set()

    async def _resolve(self, name: str) -> None:
        try:
            info = AsyncServiceInfo(SERVICE, name)
            if not await info.async_request(self._zeroconf, RESOLVE * 1000):
                raise ValueError("it does not say where it is")
            announcement = read(name, info.port, info.properties, info.parsed_addresses(IPVersion.V4Only))
        except BadTypeInNameException:
            self.refused[name] = "its name is not one of an arena"
        except ValueError as error:
            self.refused[name] = str(error)
        else:
            self.refused.pop(name, None)
            others = [one for one in self.announced.get(name, []) if one != announcement]
            self.announced[name] = [*others[1 - MAX_CLAIMS :], announcement]
        self.news.set()


@contextlib.asynccontextmanager
async def searching(wanted: str = "") -> AsyncIterator[Search]:
    """A search in all networks of this machine. OSError when there is none, or when multicast is not possible."""
    logging.getLogger("zeroconf").setLevel(logging.CRITICAL)  # it writes a traceback for anybody's broken packet
    interfaces = [address.ip for address in lan_addresses()]
    if not interfaces:
        raise OSError(without_network())
    zeroconf = AsyncZeroconf(interfaces=interfaces, ip_version=IPVersion.V4Only)
    search = Search(zeroconf.zeroconf, wanted)
    browser = AsyncServiceBrowser(zeroconf.zeroconf, [SERVICE], handlers=[search.heard])
    try:
        yield search
    finally:
        await browser.async_cancel()
        await search.close()
        await zeroconf.async_close()


async def find(wanted: str) -> tuple[Announcement, str]:
    """The arena `wanted` ("": the only one), and the address of its that answers as a ROS master.

    NoArenaError when there is none. Without a name all arenas get LISTEN s to be heard.
    """
    try:
        async with searching(wanted) as search:
            end = time.monotonic() + LISTEN
            while time.monotonic() < end:
                await _news(search, end - time.monotonic())
                found = await answering(search.named(wanted)) if wanted else None
                if found:
                    return found
            arena = _chosen(search, wanted)
            found = await answering(search.named(arena))
    except OSError as error:
        text = f"no arena can be heard here: {error}; connect it, or set LASERBOT_MASTER to the master's address"
        raise UnheardError(text) from None
    if not found:
        addresses = ", ".join(sorted({address for one in search.named(arena) for address in one.addresses}))
        raise NoArenaError(f"arena {arena!r} is announced at {addresses}, but no ROS master answers there")
    return found


async def find_again(arena: str, lost: tuple[str, int] | None = None) -> tuple[Announcement, str]:
    """The arena of that name, as soon as it is announced at an address that answers. Waits for ever.

    `lost` is the address and port of the ROS master that one had: as long as that answers, nothing else is taken.
    """
    while True:
        with contextlib.suppress(OSError):  # there is no network now
            async with searching(arena) as search:
                end = time.monotonic() + ROUND
                while time.monotonic() < end and not search.is_flooded():
                    await _news(search, PAUSE)
                    found = await answering(search.named(arena))
                    # asked last: whoever has just been plugged in again hears both at the same time
                    if found and not (lost and await is_master(*lost)):
                        return found
                    await asyncio.sleep(PAUSE)
        await asyncio.sleep(PAUSE)


async def answering(announcements: Iterable[Announcement]) -> tuple[Announcement, str] | None:
    """The first of these, and its address, at which a ROS master answers; in networks of this machine first."""
    networks = [ipaddress.ip_network(f"{own.ip}/{own.prefix}", strict=False) for own in lan_addresses()]

    def is_far(place: tuple[Announcement, str]) -> bool:
        return not any(ipaddress.ip_address(place[1]) in network for network in networks)

    places = sorted(((one, address) for one in announcements for address in one.addresses), key=is_far)
    answers = await asyncio.gather(*(is_master(address, one.ros) for one, address in places))
    return next((place for place, answers_there in zip(places, answers, strict=True) if answers_there), None)


def _chosen(search: Search, wanted: str) -> str:
    """The name of the arena to join; NoArenaError also tells what was passed over."""
    try:
        return choose(search.all(), wanted).arena
    except UnheardError as error:
        if not search.refused:
            raise
        raise NoArenaError(f"{error}{search.passed_over()}") from None
    except NoArenaError as error:
        raise NoArenaError(f"{error}{search.passed_over()}") from None


async def _news(search: Search, seconds: float) -> None:
    """Wait until something was heard, at most so long."""
    with contextlib.suppress(TimeoutError):
        await asyncio.wait_for(search.news.wait(), max(0.0, seconds))
    search.news.clear()
