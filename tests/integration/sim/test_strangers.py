"""Strangers' sockets at the arena's page: each address has a share of them, and none may be silent."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest
import requests
from websockets.exceptions import InvalidStatus

from laser_bot_battle.openings import MOST, OF_ADDRESS
from laser_bot_battle.proxies import FORWARDED
from sim.arena.visits import OF_ONE
from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.polling import LATEST
from tests.support.sockets import connect, connect_unread

REQUEST = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"
FROM = "127.0.0.2"  # where no proxy is


@contextmanager
def stranger(arena: Arena, says: bytes = b"", address: str = FROM) -> Iterator[socket.socket]:
    with socket.create_connection((HOST, arena.view_port), timeout=20, source_address=(address, 0)) as other:
        other.sendall(says)
        yield other


def is_cut(other: socket.socket) -> bool:
    try:
        return other.recv(1) == b""
    except ConnectionResetError:
        return True


def answer(other: socket.socket) -> bytes:
    """The first bytes of one, or none."""
    try:
        return other.recv(65536)[:15]
    except ConnectionResetError:
        return b""


def test_silent_sockets_of_one_address_take_nobodys_place(arena: Arena) -> None:
    with ExitStack() as stack:
        for _ in range(OF_ADDRESS):
            stack.enter_context(stranger(arena))
        assert is_cut(stack.enter_context(stranger(arena)))
        with Hardware(arena, "virtual1") as robot:
            assert robot.line() == "light 0"
            assert list(arena.look()) == ["virtual1"]


def test_of_too_many_silent_sockets_the_slowest_gives_way(arena: Arena) -> None:
    with ExitStack() as stack:
        silent = [
            stack.enter_context(stranger(arena, address=f"127.0.0.{2 + number // OF_ADDRESS}"))
            for number in range(MOST)
        ]
        assert arena.look() == {}
        assert is_cut(silent[0])


def test_one_address_has_a_share_of_all_sockets(arena: Arena) -> None:
    with ExitStack() as stack:
        for _ in range(OF_ONE):
            assert answer(stack.enter_context(stranger(arena, REQUEST))) == b"HTTP/1.1 200 OK"
        assert answer(stack.enter_context(stranger(arena))) == b""
        assert requests.get(arena.page, timeout=LATEST).ok


def test_one_address_has_a_share_of_the_view_also_behind_a_proxy(arena: Arena) -> None:
    ann, bob = {FORWARDED: "192.0.2.1"}, {FORWARDED: "192.0.2.2"}
    with ExitStack() as stack:
        for _ in range(OF_ADDRESS):
            stack.enter_context(connect_unread(arena.view_url, additional_headers=ann))
        with pytest.raises(InvalidStatus, match="503"), connect(arena.view_url, additional_headers=ann):
            pass
        with connect(arena.view_url, additional_headers=bob) as viewer:
            assert viewer.recv(timeout=LATEST)


@pytest.mark.slow  # the time is real
@pytest.mark.parametrize("says", [b"", REQUEST[:20], REQUEST, REQUEST + REQUEST[:20]])
def test_a_socket_that_asks_for_nothing_is_closed(arena: Arena, says: bytes) -> None:
    with stranger(arena, says) as other:
        while not is_cut(other):
            pass


def test_a_request_in_pieces_is_answered(arena: Arena) -> None:
    with stranger(arena, REQUEST[:20]) as other:
        other.sendall(REQUEST[20:-1])
        other.sendall(REQUEST[-1:] + REQUEST)
        heard = b""
        while heard.count(b"HTTP/1.1 200 OK") < 2:
            heard += other.recv(65536)
