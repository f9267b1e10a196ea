"""How often a subscriber gets messages, and what becomes of those that must wait."""

import json

from server.rosbridge.outbox import MAX_BYTES, MAX_REPLIES, Outbox
from server.rosbridge.subscription import Subscription


def subscription(throttle: float = 0.0, queue_length: int = 0) -> Subscription:
    new = Subscription("client", "/a")
    new.add(None, throttle, queue_length)
    return new


def sent(text: str | None) -> object:
    return json.loads(text)["msg"] if text else None


def test_a_message_is_sent_by_the_name_that_the_client_uses() -> None:
    assert subscription().offer('{"data":1}', 0.0) == '{"op":"publish","topic":"/a","msg":{"data":1}}'


def test_without_throttle_every_message_is_sent_at_once() -> None:
    unthrottled = subscription()
    assert [sent(unthrottled.offer(str(n), 0.0)) for n in range(3)] == [0, 1, 2]


def test_a_throttled_subscription_drops_what_comes_too_soon() -> None:
    throttled = subscription(0.1)
    assert [sent(throttled.offer(str(n), n * 0.04)) for n in range(6)] == [0, None, None, 3, None, None]
    assert throttled.due is None


def test_with_a_queue_the_newest_wait_for_their_time() -> None:
    queued = subscription(1.0, 2)
    assert [sent(queued.offer(str(n), 10.0)) for n in range(4)] == [0, None, None, None]
    assert queued.due == 11.0
    assert queued.release(10.9) is None
    assert sent(queued.release(11.0)) == 2
    assert sent(queued.offer("4", 12.5)) is None
    assert sent(queued.release(12.5)) == 3
    assert sent(queued.release(13.5)) == 4
    assert queued.due is None
    assert queued.release(20.0) is None


def test_several_requests_agree_on_the_lowest_throttle_and_the_longest_queue() -> None:
    shared = subscription(5.0, 1)
    shared.add("second", 1.0, 3)
    assert shared.queue_length == 3
    assert sent(shared.offer("0", 0.0)) == 0
    assert sent(shared.offer("1", 1.0)) == 1
    assert not shared.remove("second")
    assert shared.queue_length == 1
    assert sent(shared.offer("2", 4.0)) == 2
    assert shared.offer("3", 8.9) is None
    assert shared.remove(None)


def test_nothing_is_due_after_the_end() -> None:
    queued = subscription(1.0, 2)
    queued.offer("0", 0.0)
    queued.offer("1", 0.0)
    queued.end()
    assert queued.due is None


def test_of_each_topic_the_newest_messages_wait_and_order_is_kept() -> None:
    outbox = Outbox()
    outbox.message("/a", "a1", 1)
    outbox.reply("r1")
    outbox.message("/b", "b1", 2)
    outbox.message("/a", "a2", 1)
    outbox.message("/b", "b2", 2)
    outbox.message("/b", "b3", 2)
    assert not outbox.is_full
    waiting = []
    while outbox:
        waiting.append(outbox.next())
    assert waiting == ["r1", "a2", "b2", "b3"]


def test_too_many_replies_or_bytes_fill_it() -> None:
    outbox = Outbox()
    for _ in range(MAX_REPLIES):
        outbox.reply("r")
    assert not outbox.is_full
    outbox.reply("r")
    assert outbox.is_full
    outbox.next()
    assert not outbox.is_full
    outbox.message("/a", "x" * MAX_BYTES, 1)
    assert outbox.is_full
