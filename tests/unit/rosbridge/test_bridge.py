"""What rosbridge keeps of its clients."""

import asyncio
import gc
import io
import weakref
from types import SimpleNamespace
from typing import Any

import pytest
from nav_msgs.msg import OccupancyGrid

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
            subscriber.received(status.getvalue(), {})
        bridge.disconnected(client)
        forgotten = weakref.ref(client)
        del client
        async with asyncio.timeout(60):  # to collect takes a second where much is loaded and the machine is busy
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


def test_who_unsubscribes_while_a_large_message_is_encoded_does_not_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "nav_msgs/OccupancyGrid"

    async def scenario() -> list[str]:
        node = Node("rosbridge", "http://127.0.0.1:1")
        bridge = Bridge(node, Types(), Clock(), Gate(""), is_open=True)
        encoded = asyncio.Event()
        heard: list[str] = []

        async def make(*_: object) -> bytes:
            await encoded.wait()
            return b"frames"

        monkeypatch.setattr(bridge.outside, "make", make)
        for name in ("stays", "goes"):
            connection: Any = SimpleNamespace(
                address=name, move=lambda _: None, message=lambda *_, name=name: heard.append(name)
            )
            client = bridge.connected(connection, GUEST)
            bridge.received(client, f'{{"op":"subscribe","topic":"/map","type":"{text}"}}')
        async with asyncio.timeout(10):
            while len(list(bridge._graph.subscriptions("/map"))) < 2:  # the ROS master is asked for its type first
                await asyncio.sleep(0.01)
            (subscriber,) = [each for each in node.subscribers() if each.topic == "/map"]
            subscriber.received(large_map(), {})
            bridge.received(client, '{"op":"unsubscribe","topic":"/map"}')
            encoded.set()
            while bridge._queues:
                await asyncio.sleep(0.01)
        return heard

    assert asyncio.run(scenario()) == ["stays"]


def test_what_a_client_that_has_gone_has_asked_at_length_opens_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    async def scenario() -> dict[str, str]:
        bridge = Bridge(Node("rosbridge", "http://127.0.0.1:1"), Types(), Clock(), Gate(""), is_open=True)
        before = bridge._graph.types()
        read = asyncio.Event()

        async def do(*_: object) -> dict[str, str]:
            await read.wait()
            return {"op": "advertise", "topic": "/game_status2", "type": "std_msgs/String"}

        monkeypatch.setattr(bridge.outside, "do", do)
        connection: Any = SimpleNamespace(address="here", move=lambda _: None, hold=lambda: None, release=lambda: None)
        client = bridge.connected(connection, GUEST)
        bridge.received(client, " " * 100_000)
        bridge.disconnected(client)
        read.set()
        async with asyncio.timeout(10):
            while bridge._tasks:
                await asyncio.sleep(0.01)
        assert not client._waiting
        return {topic: kind for topic, kind in bridge._graph.types().items() if topic not in before}

    assert asyncio.run(scenario()) == {}


def large_map() -> bytes:
    data = io.BytesIO()
    OccupancyGrid(data=[0] * 100_000).serialize(data)
    return data.getvalue()
