"""What waits of a topic while a large message is encoded."""

from server.messages.types import Types
from server.rosbridge.delivery import Delivery
from server.rosbridge.line import MAX_WAITING, Line
from server.rosbridge.subscription import Subscription

TYPE = Types().message("std_msgs/String")
WHO = [Subscription("client", "/a")]


def messages(*lengths: int) -> list[Delivery]:
    return [Delivery(TYPE, bytes(length), 0) for length in lengths]


def taken(line: Line) -> list[Delivery]:
    found = []
    while line:
        message, subscriptions = line.next()
        assert subscriptions is WHO
        found.append(message)
    return found


def test_messages_leave_in_their_order() -> None:
    line, sent = Line(), messages(3, 1, 2)
    for message in sent:
        line.put(message, WHO)
    assert taken(line) == sent
    assert not line


def test_the_oldest_give_way_when_all_together_are_too_long() -> None:
    line, sent = Line(), messages(*[MAX_WAITING // 4] * 7, 1)
    for message in sent:
        line.put(message, WHO)
    assert taken(line) == sent[-4:]
    for message in sent[:4]:
        line.put(message, WHO)
    assert taken(line) == sent[:4], "those that have left count no more"


def test_the_newest_has_a_place_however_long_it_is() -> None:
    line, (short, long) = Line(), messages(1, MAX_WAITING + 1)
    line.put(short, WHO)
    line.put(long, WHO)
    assert taken(line) == [long]
