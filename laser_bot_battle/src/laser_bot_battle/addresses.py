"""This machine's own addresses."""

import logging
import os
import socket
import time
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import ifaddr

from laser_bot_battle import netlink, variables
from laser_bot_battle.interfaces import Choice, Interface, LanAddress, UnknownInterfaceError, choose
from laser_bot_battle.plain_address import plain_address
from laser_bot_battle.settings import SettingsError

_LASTS = 5.0  # s that the addresses of this machine are taken to stay
_ANY = ("0.0.0.0", "::")

_log = logging.getLogger(__name__)


def lan_addresses() -> list[LanAddress]:
    """This machine's IPv4 addresses that others can reach; first the one towards most others. Perhaps none."""
    return list(lan_choice().taken)


def lan_choice() -> Choice:
    """The addresses that count, and why: those of LASERBOT_INTERFACE, if that is set."""
    try:
        found = _interfaces()
    except OSError as error:
        return Choice((), f"cannot list this machine's networks: {error.strerror or error}", ())
    try:
        return choose(found, variables.INTERFACE.read(os.environ))
    except (UnknownInterfaceError, SettingsError) as error:  # it was there when the program started
        return Choice((), str(error), ())


def without_network() -> str:
    """That this machine is in no network, for people, with what was left out."""
    choice = lan_choice()
    is_plain = not choice.left_out and not os.environ.get(variables.INTERFACE.name)
    return "this machine has no address in any network" + ("" if is_plain else f": {choice}")


def check_interface(environ: Mapping[str, str]) -> None:
    """SettingsError if LASERBOT_INTERFACE says an interface, an address or a network that there is not now."""
    wanted = variables.INTERFACE.read(environ)
    try:
        if wanted:
            choose(_interfaces(), wanted)
    except UnknownInterfaceError as error:
        raise SettingsError(f"{variables.INTERFACE.name}={' '.join(wanted)}: {error}") from None
    except OSError as error:
        _log.warning("cannot list this machine's networks: %s", error)


def reachable_addresses(bind: str) -> list[LanAddress]:
    """Those of lan_addresses() at which others find a program that listens on `bind`; `bind` may be a host's name.

    An address that somebody binds to counts, whatever network it is in.
    """
    try:
        found = socket.getaddrinfo(bind, None, type=socket.SOCK_STREAM)
    except OSError:
        return []
    listening = {place[0] for *_, place in found}
    everywhere = not listening.isdisjoint(_ANY)
    if everywhere:
        return lan_addresses()
    left_out = [address for address, _ in lan_choice().left_out]
    return [address for address in (*lan_addresses(), *left_out) if address.ip in listening]


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


def _interfaces() -> list[Interface]:
    """OSError if the system does not tell."""
    return netlink.interfaces() if hasattr(socket, "AF_NETLINK") else [_interface(adapter) for adapter in _adapters()]


def _interface(adapter: Any) -> Interface:
    """Of a system that is not Linux: it does not tell what its interfaces are, so each counts."""
    name, own = adapter.nice_name, [address for address in adapter.ips if address.is_IPv4]
    return Interface(
        index=adapter.index or 0,
        name=name,
        addresses=tuple(LanAddress(str(address.ip), address.network_prefix, name) for address in own),
        is_hardware=True,
        is_loopback=any(str(address.ip).startswith("127.") for address in own),
    )


def _adapters() -> list[Any]:
    return list(ifaddr.get_adapters())
