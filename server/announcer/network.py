"""Multicast DNS in several networks, in each with this machine's own addresses there.

zeroconf sends the same packets into all of its networks. A browser or a robot that hears the address of another
network, too, takes either of them, and may reach none.
"""

from collections.abc import Sequence
from ipaddress import IPv4Address
from typing import Any

from zeroconf import DNSAddress, DNSOutgoing, IPVersion, Zeroconf
from zeroconf.asyncio import AsyncZeroconf

from laser_bot_battle.interfaces import LanAddress

MDNS_PORT = 5353


def open_networks(addresses: Sequence[LanAddress]) -> AsyncZeroconf:
    """In the networks of these addresses. OSError if multicast is not possible there."""
    return AsyncZeroconf(zc=_Networks(addresses))


def elsewhere(own: Sequence[LanAddress], sender: str, to: str | None) -> set[str]:
    """Those of our own addresses that are not in the network of a packet, sent from the address `sender`.

    An answer `to` one machine may come from the socket that hears all networks, which has no address.
    """
    here = {address.interface for address in own if address.ip == sender}
    if not here and to:
        here = {address.interface for address in own if IPv4Address(to) in address.network}
    return {address.ip for address in own if here and address.interface not in here}


def fitting(packet: DNSOutgoing, without: set[str]) -> DNSOutgoing:
    """The packet without those of its records that say one of these addresses."""
    packed = {IPv4Address(address).packed for address in without}
    fit = DNSOutgoing(packet.flags, packet.multicast, packet.id)

    def is_here(record: object) -> bool:
        return not (isinstance(record, DNSAddress) and record.address in packed)

    fit.questions = packet.questions
    fit.authorities = packet.authorities
    fit.answers = [(record, now) for record, now in packet.answers if is_here(record)]
    fit.additionals = [record for record in packet.additionals if is_here(record)]
    return fit


class _Networks(Zeroconf):
    def __init__(self, addresses: Sequence[LanAddress]) -> None:
        self._own = addresses
        super().__init__(interfaces=[own.ip for own in addresses], ip_version=IPVersion.V4Only)

    def async_send(
        self,
        out: DNSOutgoing,
        addr: str | None = None,
        port: int = MDNS_PORT,
        v6_flow_scope: tuple[()] | tuple[int, int] = (),
        transport: Any = None,
    ) -> None:
        """Called by zeroconf for each packet; without a transport it is for all networks."""
        if self.done:
            return
        for each in [transport] if transport else self.engine.senders:
            fit = fitting(out, elsewhere(self._own, each.sock_name[0], addr))
            super().async_send(fit, addr, port, v6_flow_scope, each)
