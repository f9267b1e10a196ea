"""Clients that read, though not at every moment: what they have asked for comes, and nobody closes them."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import Client, RosSide, join
from tests.support.bare import BareClient
from tests.support.polling import until

Connect = Callable[..., Client]

MEGABYTE = 10**6
TEXT = "std_msgs/String"


@pytest.fixture
def late(rosbridge: Rosbridge) -> Iterator[BareClient]:
    """An operator who reads only when told to."""
    with BareClient(rosbridge.port, receive_buffer=2**16) as bare:
        bare.say("auth", client="operator", mac="the operators' token")
        yield bare


def answers(reader: BareClient, count: int) -> list[dict[str, Any]]:
    return [reader.hear() for _ in range(count)]


@pytest.mark.parametrize("queue_length", [0, 10])
def test_a_burst_of_long_messages_comes_whole(
    ros: RosSide, late: BareClient, client: Connect, queue_length: int
) -> None:
    topic, watcher = f"/burst{queue_length}", client().operate()
    watcher.say("subscribe", topic=topic, type=TEXT, queue_length=1)
    join(lambda data: ros.publish(topic, TEXT, data=data), watcher)
    late.say("subscribe", topic=topic, type=TEXT, queue_length=queue_length)
    late.say("call_service", service="/add_new_robot")
    assert late.hear()["result"] is True  # so it is subscribed
    texts = [str(number).ljust(MEGABYTE, "x") for number in range(10)]
    for text in texts:
        ros.publish(topic, TEXT, data=text)
    until(lambda: watcher.hear()["msg"]["data"] == texts[-1])
    assert [answer["msg"]["data"][0] for answer in answers(late, 10)] == list("0123456789")


def test_long_latched_messages_of_several_topics_come(late: BareClient, client: Connect) -> None:
    topics = ["/map0", "/map1", "/map2"]
    maps, watcher = client().operate(), client().operate()
    for topic in topics:
        maps.say("advertise", topic=topic, type=TEXT, latch=True)
        maps.say("publish", topic=topic, msg={"data": topic.ljust(3 * MEGABYTE)})
        watcher.say("subscribe", topic=topic, type=TEXT)
        assert watcher.hear(10)["topic"] == topic
    for topic in topics:
        late.say("subscribe", topic=topic)
    assert sorted(answer["topic"] for answer in answers(late, 3)) == topics


@pytest.mark.parametrize(("calls", "options"), [(1, {"fragment_size": 1000}), (30, {})], ids=["in parts", "many"])
def test_long_answers_of_services_come(late: BareClient, client: Connect, calls: int, options: dict[str, Any]) -> None:
    text, server = "x" * 400_000, client().operate()
    server.say("advertise_service", service="/long", type="std_srvs/Trigger")
    until(lambda: known(late, "/long"))
    for number in range(calls):
        late.say("call_service", service="/long", id=number, **options)
    for _ in range(calls):
        call = server.hear()
        server.say("service_response", service="/long", id=call["id"], values={"message": text}, result=True)
    server.say("call_service", service="/no_such_service")
    server.hear_error()
    parts = answers(late, calls)
    if options:
        parts += answers(late, parts[0]["total"] - 1)
        assert {part["num"] for part in parts} == set(range(len(parts)))
        assert "".join(part["data"] for part in parts).count("x") == len(text)
    else:
        assert sorted(part["id"] for part in parts) == list(range(calls))
        assert all(part["values"]["message"] == text for part in parts)


def known(caller: BareClient, service: str) -> bool:
    """ROS knows the service."""
    caller.say("call_service", service="/rosapi/service_type", args={"service": service})
    return bool(caller.hear()["values"].get("type"))
