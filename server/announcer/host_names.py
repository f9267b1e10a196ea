"""The master's host names, answered for where nobody else does.

zeroconf answers for the host of a service that it announces, so each name is the host of one, of a standard type.
"""

import asyncio
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from ipaddress import IPv4Address

from zeroconf import AddressResolverIPv4, DNSAddress, DNSRecord, Zeroconf
from zeroconf.asyncio import AsyncServiceInfo, AsyncZeroconf

from laser_bot_battle.addresses import own_addresses
from laser_bot_battle.announcement import shortened
from laser_bot_battle.interfaces import LanAddress
from laser_bot_battle.names import MASTER_HOST, MASTER_HOST_ALIAS
from server.announcer.held_name import ADDRESS, Challenge
from server.announcer.settings import Settings

ASK = 1.5  # s for somebody to answer: a lost question is asked again after 1
AGAIN = 30.0  # s until those to whom a name was left are asked whether they still answer
IPV4_BYTES = 4

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class HostName:
    """A name, and the service whose host it is."""

    name: str
    service: str
    port: int


def host_names(settings: Settings) -> list[HostName]:
    """The master's names."""
    return [
        HostName(MASTER_HOST_ALIAS, "_http._tcp.local.", settings.web),
        HostName(MASTER_HOST, "_ros-master._tcp.local.", settings.ros),
    ]


async def hold(zeroconf: AsyncZeroconf, host: HostName, arena: str, addresses: Sequence[LanAddress]) -> None:
    """Answer for the name whenever nobody else does, until this is cancelled."""
    left_to_others = False
    while True:
        other = await answering(zeroconf.zeroconf, host.name)
        if not other:
            left_to_others = False
            other = await _answer(zeroconf, host, arena, addresses)
        if not left_to_others:
            _log.info("%s is left to %s, which answers for it", host.name, other)
        left_to_others = True
        await asyncio.sleep(AGAIN)


async def answering(zeroconf: Zeroconf, name: str) -> str | None:
    """The address with which somebody answers for the host `name` now, None if nobody does."""
    resolver = AddressResolverIPv4(f"{name}.")
    # whoever was heard earlier may be gone
    zeroconf.cache.async_remove_records(zeroconf.cache.async_entries_with_name(f"{name}."))
    if not await resolver.async_request(zeroconf, ASK * 1000):
        return None
    return resolver.parsed_addresses()[0]


async def _answer(zeroconf: AsyncZeroconf, host: HostName, arena: str, addresses: Sequence[LanAddress]) -> str:
    """Answer for the name until a machine with a higher address in one network does so, too; returns that."""
    info = AsyncServiceInfo(
        host.service,
        f"{shortened(f'LaserBot Battle {arena}')}.{host.service}",
        port=host.port,
        server=f"{host.name}.",
        parsed_addresses=[address.ip for address in addresses],
    )
    await zeroconf.async_register_service(info, allow_name_change=True)
    _log.info("%s is this machine", host.name)

    def rival(record: DNSRecord) -> str | None:
        return stronger(record, beside(record, addresses))

    challenge = Challenge(zeroconf.zeroconf, info.server or "", ADDRESS, rival)
    other = await challenge.wait()
    await zeroconf.async_unregister_service(info)
    return other


def beside(record: DNSRecord, addresses: Sequence[LanAddress]) -> list[str]:
    """Those of these addresses that the record's machine can see: the ones in its network. All, if there is none."""
    if isinstance(record, DNSAddress) and len(record.address) == IPV4_BYTES:
        there = IPv4Address(record.address)
        seen = [address.ip for address in addresses if there in address.network]
        if seen:
            return seen
    return [address.ip for address in addresses]


def stronger(record: DNSRecord, addresses: list[str]) -> str | None:
    """The record's address if it is another machine's, above all of `addresses`."""
    if not isinstance(record, DNSAddress) or len(record.address) != IPV4_BYTES:
        return None
    address = IPv4Address(record.address)
    is_above = address > max(map(IPv4Address, addresses))
    return str(address) if is_above and str(address) not in own_addresses() else None
