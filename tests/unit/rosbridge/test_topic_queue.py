"""The messages of a topic that wait while a large one is encoded."""

from server.messages.types import Types
from server.rosbridge.delivery import Delivery
from server.rosbridge.subscription import Subscription
from server.rosbridge.topic_queue import MAX_WAITING, TopicQueue

TYPE = Types().message("std_msgs/String")
WHO = [Subscription("client", "/a")]


def messages(*lengths: int) -> list[Delivery]:
    return [Delivery(TYPE, bytes(length), 0) for length in lengths]


def taken(queue: TopicQueue) -> list[Delivery]:
    found = []
    while queue:
        message, subscriptions = queue.next()
        assert subscriptions is WHO
        found.append(message)
    return found


def test_messages_leave_in_their_order() -> None:
    queue, sent = TopicQueue(), messages(3, 1, 2)
    for message in sent:
        queue.put(message, WHO)
    assert taken(queue) == sent
    assert not queue


def test_the_oldest_give_way_when_all_together_are_too_long() -> None:
    queue, sent = TopicQueue(), messages(*[MAX_WAITING // 4] * 7, 1)
    for message in sent:
        queue.put(message, WHO)
    assert taken(queue) == sent[-4:]
    for message in sent[:4]:
        queue.put(message, WHO)
    assert taken(queue) == sent[:4], "those that have left count no more"


def test_the_newest_has_a_place_however_long_it_is() -> None:
    queue, (short, long) = TopicQueue(), messages(1, MAX_WAITING + 1)
    queue.put(short, WHO)
    queue.put(long, WHO)
    assert taken(queue) == [long]
