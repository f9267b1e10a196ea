"""What ROS tells a caller about the nodes of this machine, by the address by which the caller came."""

import pytest

from laser_bot_battle.arrival import Arrival, host_for, uri_for
from laser_bot_battle.interfaces import LanAddress

OWN = [LanAddress(ip, size) for ip, size in (("127.0.0.1", 8), ("10.9.0.1", 24), ("192.168.4.1", 24), ("10.8.0.2", 32))]
FROM_WIFI = Arrival("192.168.4.7", "192.168.4.1")
FROM_BEHIND_A_ROUTER = Arrival("172.20.0.7", "10.9.0.1")


@pytest.mark.parametrize(
    ("host", "arrival", "told"),
    [
        ("10.9.0.1", FROM_WIFI, "192.168.4.1"),
        ("10.8.0.2", FROM_WIFI, "192.168.4.1"),
        ("192.168.4.1", FROM_WIFI, "192.168.4.1"),
        ("192.168.4.1", FROM_BEHIND_A_ROUTER, "10.9.0.1"),
        # whoever is in the network of the address reaches it
        ("192.168.4.1", Arrival("192.168.4.7", "10.9.0.1"), "192.168.4.1"),
        # this machine reaches all of its own
        ("10.9.0.1", Arrival("127.0.0.1", "127.0.0.1"), "10.9.0.1"),
        ("10.9.0.1", Arrival("192.168.4.1", "192.168.4.1"), "10.9.0.1"),
        # other machines, names, and nodes that listen to this machine only
        ("10.9.0.5", FROM_WIFI, "10.9.0.5"),
        ("battle.local", FROM_WIFI, "battle.local"),
        ("127.0.0.1", FROM_WIFI, "127.0.0.1"),
        ("fd00::1", FROM_WIFI, "fd00::1"),
        ("10.9.0.1", Arrival("fd00::7", "fd00::1"), "10.9.0.1"),
        # an address that this machine has no more
        ("10.9.0.1", Arrival("192.168.5.7", "192.168.5.1"), "10.9.0.1"),
        ("10.9.0.1", None, "10.9.0.1"),
        ("", FROM_WIFI, ""),
    ],
)
def test_the_host(host: str, arrival: Arrival | None, told: str) -> None:
    assert host_for(host, arrival, OWN) == told


@pytest.mark.parametrize(
    ("uri", "told"),
    [
        ("http://10.9.0.1:4567/", "http://192.168.4.1:4567/"),
        ("rosrpc://10.9.0.1:4567", "rosrpc://192.168.4.1:4567"),
        ("http://10.9.0.1@10.9.0.5:4567/", "http://10.9.0.1@10.9.0.5:4567/"),
        ("http://[::1", "http://[::1"),
        ("", ""),
    ],
)
def test_the_uri(uri: str, told: str) -> None:
    assert uri_for(uri, FROM_WIFI, OWN) == told
