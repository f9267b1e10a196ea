"""Whose request it is, behind proxies and without."""

from ipaddress import ip_network

import pytest

from laser_bot_battle.proxies import asked, believed, is_proxy, visitor
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


@pytest.mark.parametrize(
    ("peer", "scheme", "forwarded", "host", "authority"),
    [
        ("127.0.0.1", None, None, "10.0.0.1:5000", "10.0.0.1:5000"),
        ("127.0.0.1", None, None, None, None),
        ("127.0.0.1", "http", "arena.example", "10.0.0.1:5000", "arena.example"),
        ("127.0.0.1", "https", "arena.example", "10.0.0.1:5000", "arena.example:443"),
        ("127.0.0.1", "HTTPS", "arena.example:8443", None, "arena.example:8443"),
        ("127.0.0.1", "wss", None, "[::1]", "[::1]:443"),  # some proxies say so of a WebSocket
        ("127.0.0.1", "https, http", "forged.example, arena.example", "x", "arena.example"),  # the nearest has the word
        ("127.0.0.1", "gopher", "no host", "10.0.0.1", "10.0.0.1"),
        ("10.42.3.4", "https", "", "arena.example", "arena.example:443"),
        ("::ffff:10.42.3.4", "https", None, "arena.example", "arena.example:443"),
        ("10.43.3.4", "https", "arena.example", "10.0.0.1:5000", "10.0.0.1:5000"),
        ("nobody", "https", "arena.example", "10.0.0.1:5000", "10.0.0.1:5000"),
    ],
)
def test_a_believed_proxy_says_what_the_visitor_has_asked_for(
    peer: str, scheme: str | None, forwarded: str | None, host: str | None, authority: str | None
) -> None:
    headers = {"X-Forwarded-Proto": scheme, "X-Forwarded-Host": forwarded, "Host": host}
    assert asked(peer, headers.get, PROXIES).authority == authority


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
