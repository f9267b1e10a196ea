"""Whose request it is, also behind a proxy: a proxy's word is believed, what others say of themselves is not."""

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from ipaddress import IPv4Network, IPv6Network, ip_address, ip_network
from typing import NamedTuple

from laser_bot_battle import variables
from laser_bot_battle.hosts import is_valid_host
from laser_bot_battle.plain_address import plain_address

Network = IPv4Network | IPv6Network

FORWARDED = "X-Forwarded-For"  # a list to which each proxy adds whose request it passes on
SCHEME = "X-Forwarded-Proto"
HOST = "X-Forwarded-Host"  # what the visitor's Host was
THIS_MACHINE = ("127.0.0.1", "::1")
_PORT = re.compile(r":[0-9]+$")
# some proxies call what a WebSocket begins with by the scheme of its own address
_SCHEMES = {"http": "http", "https": "https", "ws": "http", "wss": "https"}


class Asked(NamedTuple):
    """What the visitor asked for, as the nearest believed proxy says it."""

    scheme: str  # http or https
    host: str | None  # perhaps with a port; None: no host was named

    @property
    def authority(self) -> str | None:
        """The host, with its port where a proxy says by which scheme, and so by which port, it was asked for."""
        named = self.scheme == "https" and self.host and not _PORT.search(self.host)
        return f"{self.host}:443" if named else self.host


def visitor(peer: str, forwarded: str | None, proxies: Sequence[Network]) -> str:
    """The visitor's address: the peer's, or, if that is a proxy, the last of the header X-Forwarded-For."""
    if forwarded is not None and is_proxy(peer, proxies):
        with suppress(ValueError):
            return plain_address(str(ip_address(_last(forwarded))))
    return plain_address(peer)


def asked(peer: str, header: Callable[[str], str | None], proxies: Sequence[Network]) -> Asked:
    """By the header Host, or, if the peer is a proxy, by its X-Forwarded-Proto and -Host. `header` tells the value of a
    header, of several with commas between them, None without one."""
    host = header("Host")
    if not is_proxy(peer, proxies):
        return Asked("http", host)
    named = _last(header(HOST) or "")
    return Asked(_SCHEMES.get(_last(header(SCHEME) or "").lower(), "http"), named if is_valid_host(named) else host)


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


def _last(values: str) -> str:
    """What the nearest proxy has added."""
    return values.rpartition(",")[2].strip()
