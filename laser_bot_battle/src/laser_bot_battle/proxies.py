"""Whose request it is, also behind a proxy: a proxy's word is believed, what others say of themselves is not."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from ipaddress import IPv4Network, IPv6Network, ip_address, ip_network

from laser_bot_battle import variables
from laser_bot_battle.plain_address import plain_address

Network = IPv4Network | IPv6Network

FORWARDED = "X-Forwarded-For"  # a list to which each proxy adds whose request it passes on
SCHEME = "X-Forwarded-Proto"
THIS_MACHINE = ("127.0.0.1", "::1")


def visitor(peer: str, forwarded: str | None, proxies: Sequence[Network]) -> str:
    """The visitor's address: the peer's, or, if that is a proxy, the last of the header X-Forwarded-For."""
    if forwarded is not None and is_proxy(peer, proxies):
        with suppress(ValueError):
            return plain_address(str(ip_address(forwarded.rpartition(",")[2].strip())))
    return plain_address(peer)


def believed(environ: Mapping[str, str]) -> tuple[Network, ...]:
    """The proxies that the operator names, and those on this machine. SettingsError for an impossible value."""
    bind = variables.BIND.read(environ)
    own = [*THIS_MACHINE]
    with suppress(ValueError):  # a name
        own.append(str(ip_address(bind)))
    return (*(ip_network(address) for address in own), *variables.PROXIES.read(environ))


def is_proxy(peer: str, proxies: Sequence[Network]) -> bool:
    """Whether the address is one of those proxies'."""
    try:
        address = ip_address(plain_address(peer))
    except ValueError:
        return False
    return any(address in network for network in proxies)
