"""What the announcer says of its addresses, in each of its networks."""

import socket

import pytest
from zeroconf import DNSAddress, DNSOutgoing, DNSRecord, DNSText

from laser_bot_battle.interfaces import LanAddress
from server.announcer.host_names import beside
from server.announcer.network import elsewhere, fitting

OWN = [
    LanAddress("10.9.0.1", 24, "eth0"),
    LanAddress("10.9.0.9", 24, "eth0"),
    LanAddress("192.168.4.1", 24, "wlan0"),
]
TEXT = DNSText("hall.local.", 16, 1, 120, b"")


def address(ip: str) -> DNSAddress:
    return DNSAddress("hall.local.", 1, 1, 120, socket.inet_aton(ip))


@pytest.mark.parametrize(
    ("sender", "to", "others"),
    [
        ("10.9.0.9", None, {"192.168.4.1"}),
        ("192.168.4.1", None, {"10.9.0.1", "10.9.0.9"}),
        ("192.168.4.1", "10.9.0.7", {"10.9.0.1", "10.9.0.9"}),
        ("0.0.0.0", "10.9.0.7", {"192.168.4.1"}),
        ("0.0.0.0", "172.20.0.7", set()),  # from elsewhere: better too much than nothing
    ],
)
def test_a_packet_is_for_one_network(sender: str, to: str | None, others: set[str]) -> None:
    assert elsewhere(OWN, sender, to) == others


def test_it_has_the_addresses_of_that_network_only_and_all_else() -> None:
    packet = DNSOutgoing(0x8400)
    for record in (TEXT, address("10.9.0.1"), address("192.168.4.1")):
        packet.add_answer_at_time(record, 0)
        packet.add_additional_answer(record)
    fit = fitting(packet, {"192.168.4.1"})
    here: list[DNSRecord] = [TEXT, address("10.9.0.1")]
    assert [record for record, _ in fit.answers] == here
    assert fit.additionals == here
    assert (fit.flags, fit.id, fit.multicast) == (packet.flags, packet.id, packet.multicast)


def test_a_rival_is_compared_with_our_address_in_its_network() -> None:
    assert beside(address("192.168.4.7"), OWN) == ["192.168.4.1"]
    assert beside(address("10.9.0.7"), OWN) == ["10.9.0.1", "10.9.0.9"]
    assert beside(address("172.20.0.7"), OWN) == [each.ip for each in OWN]
