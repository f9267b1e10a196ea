"""Sockets that listen by IPv4 and IPv6."""

import errno
import socket
import threading
from typing import Any

import pytest

from laser_bot_battle import listening
from laser_bot_battle.listening import Listener
from tests.support.ports import free_port

HERE, HERE_6 = "127.0.0.1", "::1"


@pytest.mark.parametrize(
    ("bind", "addresses"),
    [
        ("0.0.0.0", ["0.0.0.0", "::"]),
        ("::", ["0.0.0.0", "::"]),
        (HERE, [HERE, HERE_6]),
        (HERE_6, [HERE, HERE_6]),
        ("localhost", [HERE, HERE_6]),
        ("::ffff:127.0.0.1", [HERE, HERE_6]),
        ("127.0.0.2", ["127.0.0.2"]),
        ("192.0.2.2", ["192.0.2.2"]),  # this machine has it not: to listen there tells so
    ],
)
def test_everywhere_and_this_machine_are_of_both_families_and_an_address_is_that_one(
    bind: str, addresses: list[str]
) -> None:
    assert listening.addresses(bind) == addresses


def test_where_the_kernel_has_no_ipv6_it_goes_on_without(monkeypatch: pytest.MonkeyPatch) -> None:
    class WithoutIpv6(socket.socket):
        def __init__(self, family: int = -1, *rest: Any, **more: Any) -> None:
            if family == socket.AF_INET6:
                raise OSError(errno.EAFNOSUPPORT, "Address family not supported by protocol")
            super().__init__(family, *rest, **more)

    monkeypatch.setattr(socket, "socket", WithoutIpv6)
    for bind in ("0.0.0.0", "localhost"):
        with listening.bind(bind, 0) as listener:
            assert [each.family for each in listener.sockets] == [socket.AF_INET]


def test_clients_of_both_families_come_with_the_address_that_they_have() -> None:
    with listening.bind("0.0.0.0", 0) as listener:
        listener.listen(5)
        port = listener.getsockname()[1]
        for address in (HERE, HERE_6, HERE, HERE):
            with socket.create_connection((address, port)) as client:
                accepted, (peer, number, *_) = listener.accept()
                accepted.close()
                assert (peer, number) == client.getsockname()[:2]


def test_it_waits_for_a_client_or_says_that_there_is_none() -> None:
    with listening.bind(HERE, 0) as listener:
        listener.listen(5)
        listener.setblocking(False)
        with pytest.raises(BlockingIOError):
            listener.accept()
        listener.setblocking(True)
        place = (HERE_6, listener.getsockname()[1])
        clients: list[socket.socket] = []
        thread = threading.Thread(target=lambda: clients.append(socket.create_connection(place)))
        thread.start()
        accepted, _ = listener.accept()
        thread.join()
        for one in (accepted, *clients):
            one.close()


def test_a_crowd_of_one_family_keeps_nobody_of_the_other_waiting() -> None:
    with listening.bind(HERE, 0) as listener:
        listener.listen(10)
        port = listener.getsockname()[1]
        clients = [socket.create_connection((address, port)) for address in (*[HERE] * 5, HERE_6)]
        accepted = [listener.accept() for _ in range(2)]
        for one in (*clients, *(client for client, _ in accepted)):
            one.close()
    assert {address for _, (address, *_) in accepted} == {HERE, HERE_6}


def test_a_client_by_ipv4_is_one_although_a_socket_of_both_families_accepts_it() -> None:
    both = socket.create_server(("::", 0), family=socket.AF_INET6, dualstack_ipv6=True)
    with Listener(both) as listener, socket.create_connection((HERE, both.getsockname()[1])):
        accepted, (address, *_) = listener.accept()
        accepted.close()
        assert address == HERE


@pytest.mark.parametrize("family", [socket.AF_INET, socket.AF_INET6])
def test_a_port_that_another_program_has_in_one_family_cannot_be_had(family: socket.AddressFamily) -> None:
    port = free_port()
    with socket.socket(family) as taken:
        taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        taken.bind((HERE if family == socket.AF_INET else HERE_6, port))
        taken.listen()
        with pytest.raises(OSError, match="in use"):
            listening.bind(HERE, port)
