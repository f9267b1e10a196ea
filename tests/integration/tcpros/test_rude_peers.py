"""Peers that do not read, stay silent or talk nonsense, and a master that hangs."""

import asyncio
import contextlib
import socket
import xmlrpc.client
from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

import pytest

from laser_bot_battle.master import MasterError
from tcpros import inbound, sockets, xmlrpc_server
from tcpros.node import Node
from tcpros.outgoing import MAX_WAITING, MAX_WAITING_BYTES
from tcpros.specs import ServiceSpec, TypeSpec
from tests.integration.tcpros.conftest import Scenario, StartNode
from tests.integration.tcpros.ends import STRING, RawPeer, RospyPeer, eventually, registered, text
from tests.support.ros import RosMaster

Run = Callable[[Scenario], None]

COMMAND = TypeSpec("laser_bot_battle/Robot_msg", "aa81278360e1bdd1ffce0a4efe0ae199", "")


def numbered(number: int, size: int = 4) -> bytes:
    return number.to_bytes(4, "little").ljust(size, b".")


def numbers(messages: list[bytes]) -> list[int]:
    return [int.from_bytes(message[:4], "little") for message in messages]


def test_for_who_does_not_read_the_newest_wait_bounded_and_in_order(run: Run, node: StartNode) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise("/t", STRING)
            mute = await RawPeer.subscribe(ours, "/t", 4096)
            await mute.hear_header()
            reader = await RawPeer.subscribe(ours, "/t")
            await reader.hear_header()
            await eventually(lambda: made.connections == 2)
            count, size = 1500, 20_000
            for number in range(count):
                made.publish(numbered(number, size))
                await asyncio.sleep(0)
                if number % 20 == 0:  # this one reads what has come
                    last = numbered(number, size)
                    await reader.hear_until(last)
            (waiting,) = [len(peer._waiting) for peer in made.peers() if peer._waiting]
            assert waiting <= MAX_WAITING_BYTES / size
            heard = numbers(await mute.hear_until(numbered(count - 1, size)))
            assert heard == sorted(set(heard))
            assert len(heard) < count
            assert heard[-waiting:] == list(range(count - waiting, count))
            for peer in (mute, reader):
                peer.close()
            await eventually(lambda: made.connections == 0)

    run(scenario)


def test_many_small_messages_wait_bounded_too(run: Run, node: StartNode) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise("/t", STRING)
            mute = await RawPeer.subscribe(ours, "/t", 4096)
            await mute.hear_header()
            await eventually(lambda: made.connections)
            made.publish(numbered(0, 6 * 2**20))  # fills what the kernel keeps
            await asyncio.sleep(0)
            for number in range(1, 5000):
                made.publish(numbered(number))
            await asyncio.sleep(0)
            heard = numbers(await mute.hear_until(numbered(4999)))
            assert heard == [0, *range(5000 - MAX_WAITING, 5000)]
            mute.close()

    run(scenario)


def test_a_command_leaves_at_once_or_is_dropped_and_none_is_kept(run: Run, node: StartNode) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise("/Robot1/command", COMMAND, latest=True, latch=True)
            made.publish(numbered(0))
            mute = await RawPeer.subscribe(ours, "/Robot1/command", 2048)
            reader = await RawPeer.subscribe(ours, "/Robot1/command")
            assert (await mute.hear_header())["latching"] == "0"
            await reader.hear_header()
            await eventually(lambda: made.connections == 2)
            count = 5000
            for number in range(1, count):
                made.publish(numbered(number))
                if number % 10 == 0:
                    await reader.hear_until(numbered(number))
            heard = numbers(await mute.hear())
            while True:
                try:
                    async with asyncio.timeout(0.2):
                        heard += numbers(await mute.hear())
                except TimeoutError:
                    break
            assert heard[0] == 1
            assert heard == sorted(set(heard))
            assert len(heard) < count / 2
            made.publish(numbered(count))
            assert numbers(await mute.hear()) == [count]
            mute.close()
            reader.close()

    run(scenario)


def test_garbage_and_silence_end_their_own_connection_only(
    run: Run, node: StartNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sockets, "GREETING", 0.5)
    monkeypatch.setattr(xmlrpc_server, "GREETING", 0.5)
    rubbish = [
        b"",
        b"\x05",
        b"\xff\xff\xff\xff" * 100,
        b"\x04\0\0\0\0\0\0\0",
        b"GET / HTTP/1.1\r\n\r\n",
        b"POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
        b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n",
        b"POST / HTTP/1.1\r\nContent-Length: 10\r\n\r\nxxx",
        b"POST / HTTP/1.1\r\nContent-Length: 3\r\n\r\nxxx",
        b"POST / HTTP/1.1\r\n" + b"x: y\r\n" * 10_000,
        b"\0" * 2**17,
    ]

    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise("/t", STRING)
            slave = urlsplit(ours.uri)
            peers = []
            for port in (ours.tcpros_address[1], slave.port):
                for data in rubbish:
                    connected = await asyncio.to_thread(socket.create_connection, (slave.hostname, port))
                    connected.setblocking(False)
                    peers.append(RawPeer(connected))
                    await send(peers[-1], data)
            for header in ({"topic": "/t"}, {"service": "/none", "callerid": "a", "md5sum": "*"}, {"callerid": "a"}):
                peers.append(await RawPeer.connect(ours))
                await peers[-1].say(header)
                assert "error" in await peers[-1].hear_header()
            assert all(await asyncio.gather(*(peer.ended() for peer in peers)))
            for peer in peers:
                peer.close()
            subscriber = await RawPeer.subscribe(ours, "/t")
            await subscriber.hear_header()
            await eventually(lambda: made.connections == 1)
            made.publish(text("a"))
            assert await subscriber.hear() == [text("a")]
            subscriber.close()

    async def send(peer: RawPeer, data: bytes) -> None:
        with contextlib.suppress(ConnectionError):  # refused before the end of it
            await peer.send(data)

    run(scenario)


def test_crowds_of_silent_peers_have_a_limit(run: Run, node: StartNode, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inbound, "MAX_GREETING", 3)

    async def scenario() -> None:
        async with node("ours") as ours:
            ours.advertise("/t", STRING)
            silent = [await RawPeer.connect(ours) for _ in range(4)]
            assert await silent[3].ended()
            for peer in silent:
                peer.close()
            subscriber: RawPeer | None = None
            while subscriber is None:
                subscriber = await RawPeer.subscribe(ours, "/t")
                try:
                    await subscriber.hear_header()
                except Exception:  # the places are not free yet
                    subscriber.close()
                    subscriber = None
            subscriber.close()

    run(scenario)


def test_while_the_master_hangs_known_peers_go_on(run: Run, node: StartNode, own_master: RosMaster) -> None:
    async def handle(data: bytes) -> bytes:
        return data

    async def scenario() -> None:
        async with node("ours", own_master.uri) as ours:
            made = ours.advertise("/t", STRING)
            await eventually(lambda: made.connections)
            own_master.pause()
            try:
                with pytest.raises(TimeoutError, match=r"has not answered within 0\.2 s"):
                    await ours.master("getPid", timeout=0.2)
                ours.advertise("/later", STRING).publish(text("early"))
                for number in range(100):
                    made.publish(text(str(number)))
                await eventually(lambda: len(peer.heard("/t")) == 100)
            finally:
                own_master.resume()
            await registered(ours, 0, "/later")
            own_master.pause()
        own_master.resume()

    own_master.start()
    peer = RospyPeer("peer", own_master.env)
    try:
        peer.subscribe("/t")
        run(scenario)
    finally:
        own_master.resume()
        peer.close()


def test_a_node_that_starts_before_the_master_is_registered_when_it_comes(
    run: Run, node: StartNode, own_master: RosMaster
) -> None:
    async def scenario() -> None:
        async with node("ours", own_master.uri) as ours:
            ours.advertise("/t", STRING)
            with pytest.raises(ConnectionRefusedError):
                await ours.master("getPid")
            await asyncio.to_thread(own_master.start)
            await registered(ours, 0, "/t")

    run(scenario)


def test_other_nodes_may_ask_by_the_slave_api(run: Run, node: StartNode, ros_master: RosMaster) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            reasons: list[str] = []
            ours.on_shutdown = reasons.append
            made = ours.advertise("/t", STRING)
            subscriber = ours.subscribe("/t", STRING, lambda *_: None)
            ours.serve("/s", ServiceSpec("a/B", "*"), lambda data: asyncio.sleep(0, data))
            await eventually(lambda: made.connections and subscriber.connections)
            made.publish(b"123")

            async def ask(method: str, *arguments: Any) -> Any:
                def call() -> Any:
                    with xmlrpc.client.ServerProxy(ours.uri) as proxy:
                        return getattr(proxy, method)(*arguments)

                return await asyncio.to_thread(call)

            assert await ask("getMasterUri", "/x") == [1, "", ros_master.uri]
            assert (await ask("getPublications", "/x"))[2] == [["/t", STRING.name]]
            assert (await ask("getSubscriptions", "/x"))[2] == [["/t", STRING.name]]
            outward, inward = (await ask("getBusInfo", "/x"))[2]
            assert outward[1:6] == ["/ours", "o", "TCPROS", "/t", True]
            assert inward[1:6] == [ours.uri, "i", "TCPROS", "/t", True]
            await eventually(lambda: next(iter(subscriber.peers().values())).received_bytes)
            published, subscribed, _ = (await ask("getBusStats", "/x"))[2]
            assert published[0][:2] == ["/t", 7]
            assert published[0][2][0][1:] == [7, 1, True]
            assert subscribed[0][1][0][1] == 7
            assert await ask("requestTopic", "/x", "/t", [["UDPROS"], ["TCPROS"]]) == [
                1, "ready on {}:{}".format(*ours.tcpros_address), ["TCPROS", *ours.tcpros_address],
            ]  # fmt: skip
            assert (await ask("requestTopic", "/x", "/t", [["UDPROS"]]))[0] == 0
            assert (await ask("requestTopic", "/x", "/none", [["TCPROS"]]))[0] == -1
            assert (await ask("requestTopic", "/x", "/t"))[0] == -1
            assert (await ask("requestTopic", "/x", "/t", 5))[0] == -1
            assert (await ask("publisherUpdate", "/x", "/t", [5]))[0] == -1
            assert (await ask("publisherUpdate", "/x", ["/t"], []))[0] == -1
            assert (await ask("paramUpdate", "/x", "/p", 5))[0] == -1
            assert (await ask("getPid"))[0] == -1
            assert (await ask("nonsense", "/x"))[0] == -1
            assert await ask("shutdown", "/x", "enough") == [1, "shutdown", 0]
            assert reasons == ["enough"]

    run(scenario)


def test_what_the_master_cannot_be_told_is_refused(run: Run, node: StartNode) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            deep: list[Any] = []
            for _ in range(5000):
                deep = [deep]
            for impossible in (2**40, None, deep, "\ud800"):
                with pytest.raises(MasterError, match="cannot be told"):
                    await ours.master("setParam", "/p", impossible)
            with pytest.raises(MasterError):
                await ours.master("getParam", "/none")
            with pytest.raises(ConnectionError):
                await Node("x", "http://{}:{}".format(*ours.tcpros_address)).master("getPid")
            with pytest.raises(OSError, match="XML-RPC"):
                await Node("x", "nowhere").master("getPid")
            large = {"text": "x" * 2**20, "list": list(range(1000))}
            await ours.master("setParam", "/large", large)
            assert await ours.master("getParam", "/large") == large

    run(scenario)
