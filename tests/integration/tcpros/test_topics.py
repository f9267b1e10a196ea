"""Topics between our node and rospy."""

import asyncio
import itertools
import logging
from collections.abc import Callable
from functools import partial

import pytest

from tcpros import publisher
from tcpros.specs import TypeSpec
from tests.integration.tcpros.conftest import Scenario, StartNode
from tests.integration.tcpros.ends import STRING, RospyPeer, eventually, registered, text, value
from tests.support.polling import LATEST
from tests.support.ros import RosMaster

ANYTHING = TypeSpec("*", "*", "")
Run = Callable[[Scenario], None]

_numbers = itertools.count()


@pytest.fixture
def topic() -> str:
    return f"/topic{next(_numbers)}"


def test_all_that_is_sent_right_after_advertise_reaches_who_was_there_before(
    run: Run, node: StartNode, peer: RospyPeer, topic: str
) -> None:
    texts = [str(number) for number in range(20)]

    async def scenario() -> None:
        async with node("ours") as ours:
            await registered(ours, 1, topic, by=peer.name)
            made = ours.advertise(topic, STRING)
            for one in texts:
                made.publish(text(one))
            await eventually(lambda: peer.heard(topic) == texts)
            made.publish(text("later"))
            await eventually(lambda: peer.heard(topic) == [*texts, "later"])

    peer.subscribe(topic)
    run(scenario)


@pytest.fixture
def no_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody wants to wait until it is over."""
    monkeypatch.setattr(publisher, "SAME_MOMENT", 0.0)


@pytest.mark.usefixtures("no_moment")
@pytest.mark.parametrize("waits_for", ["nobody", "one that is dead"])
def test_who_subscribes_later_gets_nothing_of_before(
    run: Run, node: StartNode, peer: RospyPeer, topic: str, waits_for: str
) -> None:
    async def scenario() -> None:
        async with node("ours") as ours, node("dead") as dead:
            if waits_for == "one that is dead":
                await dead.master("registerSubscriber", topic, STRING.name, "http://127.0.0.1:1/")
            made = ours.advertise(topic, STRING)
            made.publish(text("before"))
            ours.advertise(f"{topic}/next", STRING)  # whose turn comes when all is known about the first
            await registered(ours, 0, f"{topic}/next")
            peer.subscribe(topic)
            await eventually(lambda: made.connections)
            made.publish(text("now"))
            await eventually(lambda: peer.heard(topic))
            assert peer.heard(topic) == ["now"]

    run(scenario)


def test_what_rospy_publishes_is_received_with_the_header_of_its_connection(
    run: Run, node: StartNode, peer: RospyPeer, topic: str
) -> None:
    received = []

    async def scenario() -> None:
        async with node("ours") as ours:
            ours.subscribe(topic, ANYTHING, lambda data, header: received.append((value(data), header)))
            await eventually(lambda: received)
            assert received[0][0] == "kept"
            header = received[0][1]
            assert (header["callerid"], header["type"], header["latching"]) == ("/peer", STRING.name, "1")
            assert header["md5sum"] == STRING.md5sum
            peer.do("publish", topic, "a", "b", "c")
            await eventually(lambda: [one for one, _ in received] == ["kept", "a", "b", "c"])

    peer.advertise(topic, True)
    peer.do("publish", topic, "kept")
    run(scenario)


def test_a_subscriber_that_is_settled_misses_nothing_and_waits_for_no_dead_publisher(
    run: Run, node: StartNode, topic: str
) -> None:
    received: list[str] = []

    async def scenario() -> None:
        async with node("ours") as ours, node("other") as other:
            publisher = other.advertise(topic, STRING, latest=True)  # which keeps nothing for newcomers
            await registered(other, 0, topic)
            await ours.master("registerPublisher", topic, STRING.name, "http://127.0.0.1:1/")
            subscriber = ours.subscribe(topic, ANYTHING, lambda data, _: received.append(value(data)))
            async with asyncio.timeout(10):
                await subscriber.settled()
            publisher.publish(text("now"))
            await eventually(lambda: received == ["now"])

    run(scenario)


def test_messages_of_a_mebibyte_and_more_go_both_ways(run: Run, node: StartNode, peer: RospyPeer, topic: str) -> None:
    lengths = [2**20, 0, 5 * 2**20 + 1, 3]
    received: list[int] = []

    def heard(number: int) -> bool:
        return len(peer.heard(f"{topic}/back")) == number

    async def scenario() -> None:
        async with node("ours") as ours:
            subscriber = ours.subscribe(topic, STRING, lambda data, _: received.append(len(value(data))))
            made = ours.advertise(f"{topic}/back", STRING)
            await eventually(lambda: made.connections)
            for number, length in enumerate(lengths, 1):  # one at a time: together they are more than may wait
                made.publish(text("y" * length))
                await eventually(partial(heard, number))
            await subscriber.settled()
            peer.do("publish", topic, *lengths)
            await eventually(lambda: received == lengths)
        assert peer.heard(f"{topic}/back") == [2**20, "", 5 * 2**20 + 1, "yyy"]

    peer.advertise(topic)
    peer.subscribe(f"{topic}/back")
    run(scenario)


def test_a_newcomer_gets_the_last_message_of_a_latched_topic_once(
    run: Run, node: StartNode, peer: RospyPeer, topic: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(publisher, "EARLY", 0.0)

    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise(topic, STRING, latch=True)
            await asyncio.sleep(0.01)  # what is early is over
            made.publish(text("old"))
            made.publish(text("last"))
            peer.subscribe(topic)
            await eventually(lambda: peer.heard(topic))
            made.publish(text("new"))
            await eventually(lambda: peer.heard(topic) == ["last", "new"])
            assert [line[3] for line in peer.said if line[:2] == ["heard", topic]] == ["1", "1"]

    run(scenario)


def test_an_early_message_of_a_latched_topic_does_not_come_twice(
    run: Run, node: StartNode, peer: RospyPeer, topic: str
) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise(topic, STRING, latch=True)
            made.publish(text("first"))
            made.publish(text("last"))
            peer.subscribe(topic)
            await eventually(lambda: made.connections)
            made.publish(text("new"))
            await eventually(lambda: "new" in peer.heard(topic))
            assert peer.heard(topic) == ["first", "last", "new"]

    run(scenario)


def test_a_topic_of_another_type_is_not_received_and_it_is_said_once(
    run: Run, node: StartNode, peer: RospyPeer, topic: str, caplog: pytest.LogCaptureFixture
) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            wrong = ours.subscribe(topic, TypeSpec("std_msgs/Int8", "0" * 32, "int8 data"), lambda *_: None)
            received: list[bytes] = []
            ours.subscribe(topic, STRING, lambda data, _: received.append(data))
            peer.do("publish", topic, "kept")
            await eventually(lambda: received)
            await eventually(lambda: caplog.records)
            assert wrong.connections == 0

    peer.advertise(topic, True)
    with caplog.at_level(logging.WARNING, "tcpros"):
        run(scenario)
    (record,) = caplog.records
    assert f"/ours: no messages of {topic} come from http://" in record.getMessage()
    assert STRING.name in record.getMessage()


def test_a_subscriber_of_another_type_is_refused(run: Run, node: StartNode, peer: RospyPeer, topic: str) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            made = ours.advertise(topic, STRING)
            peer.subscribe(f"{topic}/right")
            right = ours.advertise(f"{topic}/right", STRING)
            await eventually(lambda: right.connections)
            made.publish(text("a"))
            right.publish(text("b"))
            await eventually(lambda: peer.heard(f"{topic}/right"))
            assert made.connections == 0

    peer.subscribe(topic, as_int8=True)
    run(scenario)


def test_a_topic_that_is_left_and_taken_again_reaches_its_subscribers(
    run: Run, node: StartNode, peer: RospyPeer, topic: str
) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            await registered(ours, 1, topic, by=peer.name)
            for turn in range(3):
                made = ours.advertise(topic, STRING, latch=turn == 1)
                made.publish(text(str(turn)))
                await eventually(lambda: str(turn) in peer.heard(topic))  # noqa: B023
                made.close()

    peer.subscribe(topic)
    run(scenario)


def test_a_publisher_that_was_restarted_is_connected_again(
    run: Run, node: StartNode, ros_master: RosMaster, topic: str
) -> None:
    received: list[str] = []

    async def start() -> RospyPeer:
        peer = await asyncio.to_thread(RospyPeer, f"restarted{topic[1:]}", ros_master.env)
        await asyncio.to_thread(peer.advertise, topic, True)
        return peer

    async def scenario() -> None:
        async with node("ours") as ours:
            subscriber = ours.subscribe(topic, STRING, lambda data, _: received.append(value(data)))
            for kill in (True, False):
                peer = await start()
                try:
                    peer.do("publish", topic, f"killed {kill}")
                    await eventually(lambda: f"killed {kill}" in received)  # noqa: B023
                finally:
                    await asyncio.to_thread(peer.kill if kill else peer.close)
            await eventually(lambda: subscriber.connections == 0)

    run(scenario)


def test_our_node_is_found_again_after_a_restart(run: Run, node: StartNode, peer: RospyPeer, topic: str) -> None:
    async def scenario() -> None:
        for turn in range(3):
            async with node("ours") as ours:
                await registered(ours, 1, topic, by=peer.name)
                made = ours.advertise(topic, STRING)
                made.publish(text(str(turn)))
                await eventually(lambda: peer.heard(topic)[-1:] == [str(turn)])  # noqa: B023

    peer.subscribe(topic)
    run(scenario)


def test_the_end_unregisters_all(run: Run, node: StartNode, topic: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tcpros.node.END_WITHIN", LATEST)  # on a busy machine the master needs longer

    async def scenario() -> None:
        async with node("watcher") as watcher:
            async with node("ours") as ours:
                for number in range(30):
                    ours.advertise(f"{topic}/{number}", STRING)
                ours.subscribe(topic, STRING, lambda *_: None)
                await registered(ours, 1, topic)
            assert "/ours" not in str(await watcher.master("getSystemState"))

    run(scenario)


def test_two_subscribers_of_one_topic_are_independent(run: Run, node: StartNode, peer: RospyPeer, topic: str) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            first: list[str] = []
            second: list[str] = []
            one = ours.subscribe(topic, STRING, lambda data, _: first.append(value(data)))
            await eventually(lambda: first)
            ours.subscribe(topic, STRING, lambda data, _: second.append(value(data)))
            await eventually(lambda: second)
            one.close()
            peer.do("publish", topic, "more")
            await eventually(lambda: second == ["kept", "more"])
            assert first == ["kept"]

    peer.advertise(topic, True)
    peer.do("publish", topic, "kept")
    run(scenario)
