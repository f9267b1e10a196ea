"""The desk and the log say so when most visitors seem to come from one address."""

import logging

import pytest

from server.web.one_address import MANY, MOST, PERIOD, OneAddress

NODE = "10.42.0.1"


def crowd(address: str, count: int, into: OneAddress, now: float = 0.0) -> None:
    for number in range(count):
        into.came(f"{address} {number}", address, now)


def test_a_crowd_at_one_address_is_noticed_and_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    seen = OneAddress()
    with caplog.at_level(logging.WARNING):
        crowd(NODE, MANY - 1, seen)
        assert seen.found(0) == ""
        assert not caplog.messages
        crowd(NODE, 2 * MANY, seen)
    assert seen.found(0) == NODE
    (line,) = caplog.messages
    assert NODE in line
    assert "LASERBOT_PROXIES" in line


def test_a_bot_beside_it_has_an_address_of_its_own() -> None:
    seen = OneAddress()
    seen.came("bot", "10.42.0.9", 0)
    crowd(NODE, MANY, seen)
    assert seen.found(0) == NODE


def test_a_class_behind_a_router_among_others_is_no_crowd() -> None:
    seen = OneAddress()
    crowd("203.0.113.7", MANY, seen)
    for number in range(MANY):
        crowd(f"192.168.1.{number}", 1, seen)
    assert seen.found(0) == ""


def test_one_who_comes_again_and_again_is_one() -> None:
    seen = OneAddress()
    for _ in range(10 * MANY):
        seen.came("ann", NODE, 0)
    assert seen.found(0) == ""


def test_people_at_this_machine_are_expected_to_have_its_address() -> None:
    seen = OneAddress()
    crowd("127.0.0.1", MANY, seen)
    assert seen.found(0) == ""


def test_an_evening_is_forgotten() -> None:
    seen = OneAddress()
    crowd(NODE, MANY, seen)
    assert seen.found(PERIOD - 1) == NODE
    assert seen.found(PERIOD) == ""
    crowd(NODE, MOST + MANY, seen)  # and never more is kept than that
    assert len(seen._people) == MOST
