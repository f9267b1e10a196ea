"""What a machine hears of arenas: `python -m tests.integration.discovery.ears`, until it is ended.

After each change it prints all arenas in a line of JSON: their records by their names. With words it asks for the
addresses of these host names instead, and prints those of each in a line.
"""

import asyncio
import json
import sys

from zeroconf import AddressResolverIPv4, IPVersion, ServiceStateChange, Zeroconf
from zeroconf.asyncio import AsyncServiceBrowser, AsyncServiceInfo, AsyncZeroconf

from laser_bot_battle.addresses import lan_addresses
from laser_bot_battle.announcement import SERVICE, arena_of

Records = dict[str, object]


class Ears:
    def __init__(self) -> None:
        self._arenas: dict[str, Records] = {}
        self._asking: dict[str, asyncio.Task[None]] = {}

    def heard(self, zeroconf: Zeroconf, service_type: str, name: str, state_change: ServiceStateChange) -> None:
        before = self._asking.pop(name, None)
        if before:
            before.cancel()
        elif state_change is ServiceStateChange.Updated:
            return  # an answer that was on its way when the arena was withdrawn
        if state_change is ServiceStateChange.Removed:
            self._arenas.pop(arena_of(name), None)
            self._show()
        else:
            self._asking[name] = asyncio.ensure_future(self._ask(zeroconf, name))

    async def _ask(self, zeroconf: Zeroconf, name: str) -> None:
        info = AsyncServiceInfo(SERVICE, name)
        if await info.async_request(zeroconf, 3000):
            self._arenas[arena_of(name)] = {
                "addresses": info.parsed_addresses(),
                "port": info.port,
                "text": info.decoded_properties,
                "host": info.server,
            }
            self._show()

    def _show(self) -> None:
        print(json.dumps(self._arenas), flush=True)


async def listen() -> None:
    async with open_zeroconf() as zeroconf:
        AsyncServiceBrowser(zeroconf.zeroconf, [SERVICE], handlers=[Ears().heard])
        print("{}", flush=True)
        await asyncio.Event().wait()


async def resolve(names: list[str]) -> None:
    async with open_zeroconf() as zeroconf:
        for name in names:
            resolver = AddressResolverIPv4(f"{name}.")
            await resolver.async_request(zeroconf.zeroconf, 2000)
            print(json.dumps(sorted(resolver.parsed_addresses())))


def open_zeroconf() -> AsyncZeroconf:
    return AsyncZeroconf(interfaces=[address.ip for address in lan_addresses()], ip_version=IPVersion.V4Only)


if __name__ == "__main__":
    asyncio.run(resolve(sys.argv[1:]) if sys.argv[1:] else listen())
