"""Which networks this machine is in: what each network interface is decides, and never its name.

`choose` is pure: it takes a description of the interfaces, which `netlink` reads from the kernel.
"""

import ipaddress
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

_ETHERNET = 1  # ARPHRD_ETHER: also Wi-Fi
_LAYERS = {"vlan", "macvlan", "macvtap", "ipvlan", "ipvtap"}  # they are where the interface below them is
_LINK_LOCAL = ipaddress.ip_network("169.254.0.0/16")
_NEVER = 1 << 32  # above each metric


class UnknownInterfaceError(Exception):
    """What somebody chose is not there; the text says what is."""


@dataclass(frozen=True)
class LanAddress:
    """An IPv4 address of this machine in a network, with the length of its prefix, and the interface's name."""

    ip: str
    prefix: int
    interface: str = ""

    @property
    def network(self) -> ipaddress.IPv4Network:
        return ipaddress.IPv4Network(f"{self.ip}/{self.prefix}", strict=False)


@dataclass(frozen=True)
class Interface:
    """A network interface, as the kernel describes it."""

    index: int
    name: str
    addresses: tuple[LanAddress, ...] = ()
    kind: str = ""  # of a virtual one, such as "bridge", "veth" or "tun"
    is_hardware: bool = False  # it belongs to a device, of a virtual machine too
    layer: int = _ETHERNET  # its link layer: ARPHRD_*
    is_up: bool = True
    has_carrier: bool = True
    is_loopback: bool = False
    is_single: bool = False  # point-to-point, or without neighbours to look for
    is_modem: bool = False  # of a mobile network
    master: int = 0  # index of the bridge or team that it is a port of
    below: int = 0  # index of what it is built on, or of the other end
    leads_out: bool = False  # that one is in another network namespace
    metric: int | None = None  # of its default route with a gateway, if it has one; the lowest is used


class Standing(IntEnum):
    """How likely robots and players are there: those of the best standing are taken."""

    LAN = 0  # hardware, or a bridge with a port that is
    CONTAINER = 1  # a container's own way out
    VIRTUAL = 2  # anything else that leads to a gateway
    UNPLUGGED = 3
    TUNNEL = 4  # a VPN or a modem: one peer, no neighbours
    NONE = 5


@dataclass(frozen=True)
class Choice:
    """The addresses that count, the best first, and why others do not."""

    taken: tuple[LanAddress, ...]
    why: str  # about the taken ones
    left_out: tuple[tuple[LanAddress, str], ...]

    def __str__(self) -> str:
        taken = ", ".join(map(_shown, self.taken)) or "none"
        left_out = "; ".join(f"{_shown(address)}, {why}" for address, why in self.left_out)
        return f"{taken} ({self.why})" + (f"; left out: {left_out}" if left_out else "")


_WHY = {
    Standing.LAN: "real networks",
    Standing.CONTAINER: "a container's network, as there is no other",
    Standing.VIRTUAL: "a virtual network with a gateway, as there is no other",
    Standing.UNPLUGGED: "no cable or radio, as there is no other",
    Standing.TUNNEL: "a VPN or a modem, as there is no other",
    Standing.NONE: "no network",
}


def choose(interfaces: Sequence[Interface], wanted: Sequence[str] = ()) -> Choice:
    """The addresses at which others can reach this machine.

    `wanted` are interfaces' names, addresses or networks: these count then, whatever they are, in that order.
    UnknownInterfaceError if one of them is not there.
    """
    own = [interface for interface in interfaces if not interface.is_loopback]
    if wanted:
        return _wanted(own, wanted)
    by_index = {interface.index: interface for interface in interfaces}
    judged = [(interface, *_judge(interface, by_index)) for interface in own]
    best = min((standing for interface, standing, _ in judged if interface.addresses), default=Standing.NONE)
    if best == Standing.TUNNEL and any(standing < best for _, standing, _ in judged):
        best = Standing.NONE  # the LAN has no address yet, or none for a moment
    found: list[tuple[Interface, LanAddress]] = []
    left_out: list[tuple[LanAddress, str]] = []
    for interface, standing, reason in judged:
        for address in interface.addresses:
            if standing == best != Standing.NONE:
                found.append((interface, address))
            else:
                left_out.append((address, reason))
    return Choice(tuple(address for _, address in sorted(found, key=_order)), _WHY[best], tuple(left_out))


def _wanted(interfaces: Sequence[Interface], wanted: Sequence[str]) -> Choice:
    addresses = [address for interface in interfaces for address in interface.addresses]
    taken: dict[LanAddress, None] = {}
    for word in wanted:
        matching = [address for address in addresses if _is_meant(address, word)]
        if not matching and word not in {interface.name for interface in interfaces}:
            there = [_shown(address) for address in addresses]
            there += [interface.name for interface in interfaces if interface.is_up and not interface.addresses]
            raise UnknownInterfaceError(
                f"there is no interface, address or network {word!r} on this machine; "
                f"there is {', '.join(there) or 'none besides loopback'}"
            )
        taken.update(dict.fromkeys(matching))
    left_out = [(address, "not chosen") for address in addresses if address not in taken]
    return Choice(tuple(taken), "chosen", tuple(left_out))


def _is_meant(address: LanAddress, word: str) -> bool:
    if word == address.interface:
        return True
    try:
        return ipaddress.ip_address(address.ip) in ipaddress.ip_network(word, strict=False)
    except ValueError:
        return False


def _judge(interface: Interface, by_index: dict[int, Interface]) -> tuple[Standing, str]:
    """Its standing, and why it comes after others of a better one."""
    if not interface.is_up:
        return Standing.NONE, "is down"
    if interface.is_single or interface.is_modem or interface.layer != _ETHERNET:
        return Standing.TUNNEL, "leads to one peer, as a VPN or a modem does"
    standing = _place(interface, by_index, set())
    if standing == Standing.NONE:
        return standing, "leads to this machine's containers or virtual machines only"
    if not interface.has_carrier:
        return Standing.UNPLUGGED, "has no cable or radio"
    return standing, "is virtual"


def _place(interface: Interface, by_index: dict[int, Interface], seen: set[int]) -> Standing:
    """What it leads to. `seen` keeps a circle of interfaces from being followed for ever."""
    if interface.is_hardware:
        return Standing.LAN
    seen.add(interface.index)
    ports = [port for port in by_index.values() if port.master == interface.index and port.index not in seen]
    if any(_place(port, by_index, seen) == Standing.LAN for port in ports):
        return Standing.LAN
    if interface.leads_out:
        return Standing.CONTAINER
    below = by_index.get(interface.below)
    if interface.kind in _LAYERS and below and below.index not in seen:
        return _place(below, by_index, seen)
    return Standing.VIRTUAL if interface.metric is not None and interface.kind != "veth" else Standing.NONE


def _order(place: tuple[Interface, LanAddress]) -> tuple[bool, bool, int, int]:
    """A private network before all others, an address that nobody gave last; then as the default routes say."""
    interface, address = place
    known = ipaddress.ip_address(address.ip)
    metric = _NEVER if interface.metric is None else interface.metric
    return known in _LINK_LOCAL, not known.is_private, metric, interface.index


def _shown(address: LanAddress) -> str:
    return f"{address.ip} on {address.interface}" if address.interface else address.ip
