"""What becomes of messages that must wait for a slow client."""

from server.websocket.outbox import MAX_MESSAGES, OVERHEAD, Outbox

REPLIES = 10_000  # bytes


def waiting(outbox: Outbox) -> list[bytes]:
    found = []
    while outbox:
        found.append(outbox.next())
    return found


def test_of_each_topic_the_newest_messages_wait_and_order_is_kept() -> None:
    outbox = Outbox()
    outbox.message("/a", b"a1", 1)
    outbox.reply(b"r1")
    outbox.message("/b", b"b1", 2)
    outbox.message("/a", b"a2", 1)
    outbox.message("/b", b"b2", 2)
    outbox.message("/b", b"b3", 2)
    assert waiting(outbox) == [b"r1", b"a2", b"b2", b"b3"]


def test_too_many_bytes_of_replies_are_too_much_and_one_reply_never_is() -> None:
    outbox = Outbox()
    outbox.reply(b"r" * REPLIES)
    assert not outbox.exceeds(REPLIES)
    outbox.reply(b"r")
    assert outbox.exceeds(REPLIES)
    outbox.next()
    assert not outbox.exceeds(REPLIES)
    while not outbox.exceeds(REPLIES):
        outbox.reply(b"")
    assert len(waiting(outbox)) < REPLIES / OVERHEAD + 1, "they cost memory though they are short"


def test_messages_give_way_and_replies_do_not_count_for_them() -> None:
    outbox = Outbox()
    outbox.reply(b"r" * MAX_MESSAGES)
    quarter = MAX_MESSAGES // 4
    for letter in (b"a", b"b", b"c", b"d", b"e"):
        outbox.message("/camera", letter * quarter, 0)
        assert not outbox.exceeds(MAX_MESSAGES)
    assert [message[:1] for message in waiting(outbox)] == [b"r", b"c", b"d", b"e"]


def test_every_topic_has_room_for_its_newest_message() -> None:
    outbox = Outbox()
    for letter in (b"a", b"b"):
        for topic in ("/left", "/right"):
            outbox.message(topic, letter * (MAX_MESSAGES + 1), 5)
    assert [message[:1] for message in waiting(outbox)] == [b"b", b"b"]
    outbox.message("/left", b"c", 5)
    outbox.message("/left", b"d", 5)
    assert waiting(outbox) == [b"c", b"d"]
