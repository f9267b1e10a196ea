"""Publishers that latch from the first moment on."""

from collections.abc import Iterator

import pytest
import rospy
from rospy.impl.registration import Registration, RegistrationListener, get_registration_listeners, get_topic_manager
from std_msgs.msg import Empty

from laser_bot_battle.rospy_cures import latched_publisher


class Caller(RegistrationListener):
    """Connects in the moment in which the ROS master learns of a publisher; sees whether it latches."""

    def __init__(self) -> None:
        self.seen: dict[str, bool] = {}

    def reg_added(self, name: str, _type: str, kind: str) -> None:
        if kind == Registration.PUB:
            self.seen[name] = get_topic_manager().get_publisher_impl(name).is_latch


@pytest.fixture
def caller() -> Iterator[Caller]:
    listeners = get_registration_listeners()
    caller = Caller()
    listeners.add_listener(caller)
    yield caller
    listeners.listeners.remove(caller)


def test_who_connects_at_once_is_told_that_it_latches(caller: Caller) -> None:
    publisher = latched_publisher("/cured", Empty, queue_size=1)
    assert caller.seen == {"/cured": True}
    publisher.unregister()
    assert get_topic_manager().get_publisher_impl("/cured") is None


def test_rospy_tells_it_too_late(caller: Caller) -> None:
    """Once it does not, the cure can go."""
    rospy.Publisher("/late", Empty, latch=True, queue_size=1).unregister()
    assert caller.seen == {"/late": False}
