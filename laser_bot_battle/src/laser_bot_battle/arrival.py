"""By which address of this machine a caller came, and which one ROS tells that caller.

A ROS node has one address for everybody. On a machine in two networks it is wrong in one of them: who comes from there
is told the address by which it came instead. Nodes listen at all addresses of their machine, unless theirs is loopback.
"""

from collections.abc import Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from ipaddress import IPv4Address
from urllib.parse import urlsplit

from laser_bot_battle.interfaces import LanAddress


@dataclass(frozen=True)
class Arrival:
    """A connection: the caller's address, and ours."""

    caller: str
    here: str


current: ContextVar[Arrival | None] = ContextVar("arrival", default=None)
"""of the call that is being answered, in its thread or task"""


def host_for(host: str, arrival: Arrival | None, own: Sequence[LanAddress]) -> str:
    """The host of a node for that caller: `host` itself, unless this is an address of this machine (`own`) in a network
    in which the caller is not."""
    if arrival is None:
        return host
    networks = {address.ip: address.network for address in own}
    try:
        caller, loopback = IPv4Address(arrival.caller), IPv4Address(host).is_loopback
    except ValueError:  # IPv6, or a name
        return host
    if host not in networks or loopback or arrival.here not in networks or arrival.caller in networks:
        return host
    return host if caller in networks[host] else arrival.here


def uri_for(uri: str, arrival: Arrival | None, own: Sequence[LanAddress]) -> str:
    """The same for the URI of a node or a service."""
    try:
        url = urlsplit(uri)
    except ValueError:  # anybody may register anything
        return uri
    host = url.hostname or ""
    better = host_for(host, arrival, own)
    return uri if better == host else url._replace(netloc=url.netloc.replace(host, better, 1)).geturl()
