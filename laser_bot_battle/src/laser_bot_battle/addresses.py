"""This machine's own addresses."""

import re
import socket
import time
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import ifaddr

from laser_bot_battle.plain_address import plain_address

# of containers' engines, Kubernetes and virtual machines: whoever is there is on this machine
_INTERNAL = re.compile(r"docker|br-[0-9a-f]{12}$|veth|virbr|cni|flannel|podman")
_LASTS = 5.0  # s that the addresses of this machine are taken to stay
_ANY = ("0.0.0.0", "::")
_MULTICAST_DNS = ("224.0.0.251", 5353)


@dataclass(frozen=True)
class LanAddress:
    """An IPv4 address of this machine in a network, with the length of its prefix."""

    ip: str
    prefix: int


def lan_addresses() -> list[LanAddress]:
    """This machine's IPv4 addresses that others can reach; first the one towards most others. Perhaps none."""
    found = [
        LanAddress(str(address.ip), int(address.network_prefix))
        for adapter in _adapters()
        if not _INTERNAL.match(adapter.name)
        for address in adapter.ips
        if address.is_IPv4 and not str(address.ip).startswith("127.")
    ]
    try:
        main = local_address(*_MULTICAST_DNS)
    except OSError:
        main = ""
    return sorted(found, key=lambda address: address.ip != main)


def reachable_addresses(bind: str) -> list[LanAddress]:
    """Those of lan_addresses() at which others find a program that listens on `bind`; `bind` may be a host's name."""
    try:
        found = socket.getaddrinfo(bind, None, type=socket.SOCK_STREAM)
    except OSError:
        return []
    listening = {place[0] for *_, place in found}
    everywhere = not listening.isdisjoint(_ANY)
    return [address for address in lan_addresses() if everywhere or address.ip in listening]


def own_addresses() -> set[str]:
    """All IPv4 addresses of this machine."""
    return {str(address.ip) for adapter in _adapters() for address in adapter.ips if address.is_IPv4}


def machine_of(address: str) -> str:
    """The address, or 127.0.0.1 for each, of either family, that an interface of this machine has: they all mean the
    same."""
    address = plain_address(address)
    return "127.0.0.1" if address in _own_addresses(int(time.monotonic() / _LASTS)) else address


@lru_cache(maxsize=1)
def _own_addresses(_turn: int) -> frozenset[str]:
    by_ipv6 = (str(address.ip[0]) for adapter in _adapters() for address in adapter.ips if address.is_IPv6)
    return frozenset(own_addresses()).union(by_ipv6)


def local_address(host: str, port: int) -> str:
    """This machine's IPv4 address on the route to `host`; nothing is sent. OSError if there is no route."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect((host, port))
        return str(probe.getsockname()[0])


def _adapters() -> list[Any]:
    return list(ifaddr.get_adapters())
