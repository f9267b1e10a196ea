"""What rosbridge keeps of its clients."""

import asyncio
import gc
import io
import weakref
from types import SimpleNamespace
from typing import Any

import pytest

from laser_bot_battle.msg import GameStatus
from server.access.identity import GUEST
from server.messages.types import Types
from server.rosbridge import bridge as module
from server.rosbridge.bridge import Bridge
from server.rosbridge.gate import Gate
from tcpros.clock import Clock
from tcpros.node import Node


def test_a_client_that_has_gone_while_a_throttled_message_waited_is_forgotten() -> None:
    status = io.BytesIO()
    GameStatus().serialize(status)

    async def scenario() -> None:
        node = Node("rosbridge", "http://127.0.0.1:1")  # is not started: nobody listens there
        bridge = Bridge(node, Types(), Clock(), Gate(""), is_open=False)
        connection: Any = SimpleNamespace(address="here", name="here", move=lambda _: None, message=lambda *_: None)
        client = bridge.connected(connection, GUEST)
        bridge.received(client, '{"op":"subscribe","topic":"/game_status","throttle_rate":1000000000,"queue_length":1}')
        (subscriber,) = node.subscribers()
        for _ in range(2):
            subscriber._received(status.getvalue(), {})
        bridge.disconnected(client)
        forgotten = weakref.ref(client)
        del client
        async with asyncio.timeout(10):
            while forgotten():
                gc.collect()
                await asyncio.sleep(0.05)

    asyncio.run(scenario())


def test_a_call_without_time_out_ends_with_its_client(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LAST_CALL", 0.1)

    async def scenario() -> None:
        calling, ended = asyncio.Event(), asyncio.Event()

        async def never(_: object) -> None:
            calling.set()
            try:
                await asyncio.Event().wait()
            finally:
                ended.set()

        bridge = Bridge(Node("rosbridge", "http://127.0.0.1:1"), Types(), Clock(), Gate(""), is_open=True)
        monkeypatch.setattr(bridge._ros, "call", never)
        connection: Any = SimpleNamespace(address="here", move=lambda _: None)
        client = bridge.connected(connection, GUEST)
        bridge.received(client, '{"op":"call_service","service":"/never"}')
        async with asyncio.timeout(10):
            await calling.wait()
            assert not ended.is_set()
            bridge.disconnected(client)
            await ended.wait()

    asyncio.run(scenario())
