"""The arena's own service: `_laserbot._tcp`."""

import asyncio
import logging
import secrets

from zeroconf import DNSRecord, DNSService
from zeroconf.asyncio import AsyncServiceInfo, AsyncZeroconf

from laser_bot_battle.announcement import MAX_ADDRESSES, SERVICE, Announcement, arena_of
from laser_bot_battle.names import VERSION
from server.announcer import held_name
from server.announcer.held_name import Challenge
from server.announcer.settings import Settings

# A host name of our own, for which nobody else answers: avahi, on this machine too, defends those that it knows.
HOST = f"laserbot-{secrets.token_hex(4)}.local."

_log = logging.getLogger(__name__)


async def announce_arena(zeroconf: AsyncZeroconf, settings: Settings, addresses: list[str]) -> None:
    """Announce the arena until this is cancelled, by another name if a master of the same name is there."""
    announcement = Announcement(
        settings.arena, tuple(addresses[:MAX_ADDRESSES]), settings.web, settings.rosbridge, settings.ros, VERSION
    )
    while True:
        info = service_of(announcement)
        broadcast = asyncio.ensure_future(await zeroconf.async_register_service(info, allow_name_change=True))
        name = arena_of(info.name)
        if name != settings.arena:
            _log.warning("another master is called %r: this one is called %r", settings.arena, name)
        _log.info("arena %r is announced at %s", name, ", ".join(announcement.addresses))
        await Challenge(zeroconf.zeroconf, info.name, held_name.SERVICE, _stronger).wait()
        broadcast.cancel()
        # no goodbye: it would say that the other arena goes
        zeroconf.zeroconf.registry.async_remove(info)


def service_of(announcement: Announcement) -> AsyncServiceInfo:
    """The arena's records."""
    return AsyncServiceInfo(
        SERVICE,
        f"{announcement.arena}.{SERVICE}",
        port=announcement.web,
        properties=announcement.text(),
        server=HOST,
        parsed_addresses=list(announcement.addresses),
    )


def _stronger(record: DNSRecord) -> str | None:
    return record.server if isinstance(record, DNSService) and record.server_key > HOST else None
