"""How often a subscriber gets messages, and what becomes of those that must wait."""

import json
import pickle
from typing import Any

import cbor2
import pytest

from server.messages.types import Types
from server.rosbridge.delivery import Delivery, Form
from server.rosbridge.outgoing import takes_long
from server.rosbridge.subscription import Subscription, Terms

TYPE = Types().message("std_msgs/Int8")


def subscription(throttle: float = 0.0, queue_length: int = 0) -> Subscription:
    new = Subscription("client", "/a")
    new.add(None, Terms(throttle, queue_length))
    return new


def message(number: int) -> Delivery:
    return Delivery(TYPE, bytes([number]), 1_500_000_000)


def payload(frame: bytes) -> bytes:
    """Of a short frame."""
    assert frame[1] <= 125
    return frame[2:]


def sent(delivery: Delivery | None) -> Any:
    return json.loads(payload(delivery.frames(Form("/a"))))["msg"]["data"] if delivery else None


def test_a_message_is_sent_by_the_name_that_the_client_uses() -> None:
    assert message(1).frames(Form("a")) == b'\x81\x2d{"op":"publish","topic":"a","msg":{"data":1}}'


@pytest.mark.parametrize(
    ("compression", "content"),
    [("cbor", {"data": 7}), ("cbor-raw", {"secs": 1, "nsecs": 500_000_000, "bytes": b"\x07"})],
)
def test_binary_forms_are_binary_messages(compression: str, content: object) -> None:
    frame = message(7).frames(Form("/a", compression))
    assert frame[0] == 0x82
    assert cbor2.loads(payload(frame)) == {"op": "publish", "topic": "/a", "msg": content}


def test_fragments_are_made_of_the_whole_operation() -> None:
    frames, texts = message(7).frames(Form("/a", fragment_size=30)), []
    while frames:
        length = frames[1] if frames[1] <= 125 else int.from_bytes(frames[2:4])
        start = 2 if frames[1] <= 125 else 4
        texts.append(json.loads(frames[start : start + length]))
        frames = frames[start + length :]
    assert [text["op"] for text in texts] == ["fragment"] * len(texts)
    assert "".join(text["data"] for text in texts) == '{"op":"publish","topic":"/a","msg":{"data":7}}'


def test_several_requests_agree_on_compression_and_fragments() -> None:
    shared = subscription()
    assert shared.form == Form("/a")
    shared.add(1, Terms(compression="png", fragment_size=500))
    shared.add(2, Terms(compression="cbor", fragment_size=100))
    assert shared.form == Form("/a", "cbor", 100)
    shared.remove(2)
    assert shared.form == Form("/a", "png", 500)


def test_without_throttle_every_message_is_sent_at_once() -> None:
    unthrottled = subscription()
    assert [sent(unthrottled.offer(message(n), 0.0)) for n in range(3)] == [0, 1, 2]


def test_a_throttled_subscription_drops_what_comes_too_soon() -> None:
    throttled = subscription(0.1)
    assert [sent(throttled.offer(message(n), n * 0.04)) for n in range(6)] == [0, None, None, 3, None, None]
    assert throttled.due is None


def test_with_a_queue_the_newest_wait_for_their_time() -> None:
    queued = subscription(1.0, 2)
    assert [sent(queued.offer(message(n), 10.0)) for n in range(4)] == [0, None, None, None]
    assert queued.due == 11.0
    assert queued.release(10.9) is None
    assert sent(queued.release(11.0)) == 2
    assert sent(queued.offer(message(4), 12.5)) is None
    assert sent(queued.release(12.5)) == 3
    assert sent(queued.release(13.5)) == 4
    assert queued.due is None
    assert queued.release(20.0) is None


def test_several_requests_agree_on_the_lowest_throttle_and_the_longest_queue() -> None:
    shared = subscription(5.0, 1)
    shared.add("second", Terms(1.0, 3))
    assert shared.queue_length == 3
    assert sent(shared.offer(message(0), 0.0)) == 0
    assert sent(shared.offer(message(1), 1.0)) == 1
    assert not shared.remove("second")
    assert shared.queue_length == 1
    assert sent(shared.offer(message(2), 4.0)) == 2
    assert shared.offer(message(3), 8.9) is None
    assert shared.remove(None)


def test_nothing_is_due_after_the_end() -> None:
    queued = subscription(1.0, 2)
    queued.offer(message(0), 0.0)
    queued.offer(message(1), 0.0)
    queued.end()
    assert queued.due is None


@pytest.mark.parametrize(
    ("name", "size", "compression", "long"),
    [
        ("nav_msgs/OccupancyGrid", 60_000, "none", False),
        ("nav_msgs/OccupancyGrid", 70_000, "none", True),
        ("nav_msgs/OccupancyGrid", 70_000, "cbor", False),
        ("nav_msgs/OccupancyGrid", 1_100_000, "cbor-raw", True),
        ("sensor_msgs/PointCloud2", 70_000, "none", False),
        ("sensor_msgs/PointCloud2", 70_000, "png", True),
        ("sensor_msgs/PointCloud2", 1_100_000, "none", True),
        ("std_msgs/String", 70_000, "none", False),
        ("std_msgs/String", 1_100_000, "none", True),
    ],
)
def test_what_is_long_is_made_elsewhere(name: str, size: int, compression: str, long: bool) -> None:
    assert takes_long(Types().message(name), bytes(size), compression) is long


def test_another_process_makes_the_same() -> None:
    there = pickle.loads(pickle.dumps(message(7), protocol=5))
    assert there.frames(Form("/a")) == message(7).frames(Form("/a"))


@pytest.mark.parametrize("name", ["std_msgs/Int8", "std_srvs/SetBoolRequest", "std_srvs/SetBoolResponse"])
def test_a_type_is_known_by_its_name_in_another_process(name: str) -> None:
    service = Types().service("std_srvs/SetBool")
    here = {"std_srvs/SetBoolRequest": service.request, "std_srvs/SetBoolResponse": service.response}.get(name, TYPE)
    assert pickle.loads(pickle.dumps(here)).name == here.name
