"""Announces the arena in its networks: `python3 -m server.announcer` (docs/discovery.md).

A program of its own, so that nobody's packets cost the game or rosbridge anything.
"""

import asyncio
import contextlib
import logging
import signal
import sys

from zeroconf import Zeroconf
from zeroconf.asyncio import AsyncZeroconf

from laser_bot_battle import alive
from laser_bot_battle.addresses import lan_choice, reachable_addresses
from laser_bot_battle.interfaces import LanAddress
from laser_bot_battle.log import configure_logging
from laser_bot_battle.settings import read_or_exit
from server.announcer.arena import announce_arena
from server.announcer.host_names import hold, host_names
from server.announcer.network import open_networks
from server.announcer.settings import VARIABLES, Settings
from server.program.program import read_arguments

LOOK = 0.5  # s between two looks at this machine's addresses
MAX_RECORDS = 2000  # of others, which are kept for as long as they say
FORGET = 1.0  # s between two looks at them

_ENDING = (signal.SIGINT, signal.SIGTERM)

_log = logging.getLogger(__name__)


def main() -> int:
    """The program; returns its exit code."""
    program = "python3 -m server.announcer"
    environment = read_arguments(program, "Announces the arena, so that robots and bots find it.", *VARIABLES)
    settings = read_or_exit(program, Settings.from_env, environment)
    configure_logging(settings.log_level)
    logging.getLogger("zeroconf").setLevel(logging.CRITICAL)  # it writes a traceback for anybody's broken packet
    # they wait until the announcer handles them: while asyncio sets itself up, one would end in a traceback
    signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING)
    asyncio.run(Announcer(settings).run())
    return 0


class Announcer:
    """The arena's announcement wherever the master can be reached, while this machine's networks come and go."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._ending = asyncio.Event()
        self._trouble = ""

    async def run(self) -> None:
        """Announce until SIGINT or SIGTERM, then withdraw it."""
        for number in _ENDING:
            asyncio.get_running_loop().add_signal_handler(number, self._ending.set)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDING)
        while not self._ending.is_set():
            addresses = await self._addresses()
            if addresses:
                await self._announce(addresses)
            else:
                self._say(
                    f"nothing is announced: LASERBOT_BIND={self._settings.bind} is no address in a network now; "
                    f"its networks: {lan_choice()} (LASERBOT_INTERFACE chooses)"
                )
                await self._pause()

    async def _announce(self, addresses: list[LanAddress]) -> None:
        """At these addresses, until they change or the program is to end."""
        try:
            zeroconf = open_networks(addresses)
        except OSError as error:
            where = ", ".join(address.ip for address in addresses)
            self._say(f"nothing can be announced at {where}: {error.strerror or error}; trying again")
            return await self._pause()
        self._trouble = ""
        _log.info("this machine's networks: %s (LASERBOT_INTERFACE chooses)", lan_choice())
        work = asyncio.create_task(_work(zeroconf, self._settings, addresses))
        while not self._ending.is_set() and not work.done() and set(await self._addresses()) == set(addresses):
            await self._pause()
        work.cancel()
        try:
            with contextlib.suppress(asyncio.CancelledError):
                await work
        finally:
            await zeroconf.async_close()  # says goodbye

    async def _addresses(self) -> list[LanAddress]:
        # in a thread: LASERBOT_BIND may be a name that takes a while to look up
        return await asyncio.to_thread(reachable_addresses, self._settings.bind)

    async def _pause(self) -> None:
        alive.touch()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._ending.wait(), LOOK)

    def _say(self, trouble: str) -> None:
        if trouble != self._trouble:
            _log.warning("%s", trouble)
        self._trouble = trouble


async def _work(zeroconf: AsyncZeroconf, settings: Settings, addresses: list[LanAddress]) -> None:
    async with asyncio.TaskGroup() as group:
        group.create_task(announce_arena(zeroconf, settings, [address.ip for address in addresses]))
        for name in host_names(settings):
            group.create_task(hold(zeroconf, name, settings.arena, addresses))
        group.create_task(_forget(zeroconf.zeroconf))


async def _forget(zeroconf: Zeroconf) -> None:
    """Keep what others announce from filling the memory."""
    while True:
        if sum(map(len, zeroconf.cache.cache.values())) > MAX_RECORDS:
            zeroconf.cache.async_expire(float("inf"))
        await asyncio.sleep(FORGET)


if __name__ == "__main__":
    sys.exit(main())
