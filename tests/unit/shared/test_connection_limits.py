"""ConnectionLimits for connections: so many in all, so many of another machine, and what is overdue goes."""

import contextlib
import socket
from collections.abc import Iterator

import pytest

from laser_bot_battle.connection_limits import ConnectionLimits


@pytest.fixture
def sockets() -> Iterator[list[tuple[socket.socket, socket.socket]]]:
    """Pairs of sockets: a peer's, and what it reads at the other end."""
    with contextlib.ExitStack() as stack:
        pairs = [socket.socketpair() for _ in range(6)]
        for pair in pairs:
            for end in pair:
                stack.enter_context(end)
        yield pairs


def test_one_machine_has_a_part_of_the_places_and_this_machine_all(
    sockets: list[tuple[socket.socket, socket.socket]],
) -> None:
    limits = ConnectionLimits(most=5, longest=60, of_one=2)
    peers = [peer for peer, _ in sockets]
    addresses = ("10.0.0.1", "::ffff:10.0.0.1", "10.0.0.1")
    assert [limits.take(peer, address) for peer, address in zip(peers, addresses, strict=False)] == [True, True, False]
    here = ("127.0.0.1", "::1", "::ffff:127.0.0.1", "127.0.0.1")
    assert [limits.take(peer, address) for peer, address in zip(peers[2:], here, strict=True)] == [*[True] * 3, False]
    peers[0].close()
    assert limits.take(peers[5], "10.0.0.1"), "who has closed has left"


def test_who_is_overdue_goes_and_who_has_renewed_stays(
    sockets: list[tuple[socket.socket, socket.socket]], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [100.0]
    monkeypatch.setattr("laser_bot_battle.connection_limits.time.monotonic", lambda: now[0])
    limits = ConnectionLimits(most=2, longest=5, of_one=2)
    (stalled, its_end), (busy, busy_end), (late, _), *_ = sockets
    assert limits.take(stalled, "::1")
    assert limits.take(busy, "::1")
    now[0] += 4
    limits.renew(busy)
    now[0] += 2
    assert not limits.take(late, "::1")
    assert its_end.recv(1) == b""
    busy_end.setblocking(False)
    with pytest.raises(BlockingIOError):
        busy_end.recv(1)
    stalled.close()
    assert limits.take(late, "::1")
