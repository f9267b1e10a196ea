"""Sockets of peers that may be gone already."""

import asyncio
import contextlib
import socket
import struct
from collections.abc import Callable
from typing import Any

import pytest
import uvloop

from tcpros.sockets import connect, describe, streams


def test_the_connection_of_a_peer_that_has_just_gone_can_be_described() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        peer = socket.create_connection(listener.getsockname())
        connected, _ = listener.accept()
        with connected:
            host, port = peer.getsockname()
            assert f"[{host}:{port} on socket {connected.fileno()}]" in describe(connected)
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # reset, not ended
            peer.close()
            assert "[a peer that is gone on socket" in describe(connected)


@pytest.mark.parametrize("new_loop", [asyncio.new_event_loop, uvloop.new_event_loop], ids=["asyncio", "uvloop"])
@pytest.mark.parametrize("turns", range(4))
def test_a_socket_that_is_taken_over_is_closed_once_whenever_that_is_cancelled(
    new_loop: Callable[[], asyncio.AbstractEventLoop], turns: int
) -> None:
    async def scenario() -> None:
        peer, connected = socket.socketpair()
        peer.setblocking(False)
        connected.setblocking(False)

        async def take_over() -> None:
            _, writer = await streams(connected)
            try:
                await asyncio.sleep(60)
            finally:
                writer.transport.abort()

        with peer:
            task = asyncio.create_task(take_over())
            for _ in range(1 + turns):
                await asyncio.sleep(0)
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task
            async with asyncio.timeout(5):
                assert await asyncio.get_running_loop().sock_recv(peer, 1) == b""
            assert connected.fileno() == -1

    with asyncio.Runner(loop_factory=new_loop) as runner:
        runner.run(scenario())


def test_of_a_name_with_addresses_of_both_kinds_the_one_that_ros_uses_is_called(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def resolve(_host: str, port: int, family: int, kind: int, *_: int) -> list[Any]:
        places = {socket.AF_INET6: ("::1", port, 0, 0), socket.AF_INET: ("127.0.0.1", port)}
        return [(each, kind, 0, "", place) for each, place in places.items() if family in (0, each)]

    async def scenario(port: int) -> None:
        (await connect("robot", port)).close()

    monkeypatch.delenv("ROS_IPV6", raising=False)
    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        asyncio.run(scenario(listener.getsockname()[1]))
