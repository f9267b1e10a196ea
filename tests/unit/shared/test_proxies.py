"""Whose request it is, behind proxies and without."""

from ipaddress import ip_network

import pytest

from laser_bot_battle.proxies import believed, is_proxy, visitor
from laser_bot_battle.settings import SettingsError

PROXIES = [ip_network("127.0.0.1"), ip_network("10.42.0.0/16"), ip_network("::1")]


@pytest.mark.parametrize(
    ("peer", "forwarded", "address"),
    [
        ("10.0.0.7", None, "10.0.0.7"),
        ("127.0.0.1", None, "127.0.0.1"),
        ("127.0.0.1", "10.0.0.7", "10.0.0.7"),
        ("::1", "fe80::1", "fe80::1"),
        ("10.42.3.4", "9.9.9.9, 10.0.0.7", "10.0.0.7"),  # the first was said by the visitor himself
        ("10.43.3.4", "10.0.0.7", "10.43.3.4"),
        ("127.0.0.1", "nonsense", "127.0.0.1"),
        ("127.0.0.1", "", "127.0.0.1"),
        ("", "10.0.0.7", ""),
        # as a socket for both families calls an address of IPv4
        ("::ffff:10.0.0.7", None, "10.0.0.7"),
        ("::ffff:127.0.0.1", "::FFFF:10.0.0.7", "10.0.0.7"),
        ("::ffff:a2a:304", "10.0.0.7", "10.0.0.7"),
        ("::ffff:10.43.3.4", "10.0.0.7", "10.43.3.4"),
    ],
)
def test_a_proxy_is_believed_and_nobody_else(peer: str, forwarded: str | None, address: str) -> None:
    assert visitor(peer, forwarded, PROXIES) == address


def test_what_is_no_address_is_no_proxy() -> None:
    assert not is_proxy("nobody", PROXIES)
    assert not is_proxy("127.0.0.2", PROXIES)


def test_the_front_on_this_machine_is_believed_beside_those_that_are_named() -> None:
    for environ, proxy in (
        ({}, "127.0.0.1"),
        ({"LASERBOT_BIND": "10.0.0.2"}, "10.0.0.2"),
        ({"LASERBOT_BIND": "x"}, "::1"),
    ):
        assert is_proxy(proxy, believed({**environ, "LASERBOT_PROXIES": "10.9.0.0/16"}))
    assert is_proxy("10.9.1.2", believed({"LASERBOT_PROXIES": "10.9.0.0/16"}))
    assert not is_proxy("10.9.1.2", believed({}))
    with pytest.raises(SettingsError, match="LASERBOT_PROXIES=nobody: must be addresses or networks"):
        believed({"LASERBOT_PROXIES": "nobody"})
