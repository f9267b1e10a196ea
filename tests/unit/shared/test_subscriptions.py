"""Subscriptions that miss no publisher."""

import pytest
import rospy

from laser_bot_battle.master import Master, MasterError
from laser_bot_battle.rospy_cures import UNHEARD, Subscription, hear_again


class Subscriber(rospy.Subscriber):
    """Needs no ROS master."""

    def __init__(self, name: str, publishers: int = 0) -> None:
        self.resolved_name, self.publishers = name, publishers

    def get_num_connections(self) -> int:
        return self.publishers

    def unregister(self) -> None:
        pass


class Says(Master):
    """A ROS master that knows who publishes what, or fails."""

    def __init__(self, published: list[str] | Exception) -> None:
        super().__init__("http://nowhere", "test")
        self.published, self.asked = published, 0

    def call(self, method: str, *arguments: object) -> list[list[str]]:
        assert (method, arguments) == ("getPublishedTopics", ("",))
        self.asked += 1
        if isinstance(self.published, Exception):
            raise self.published
        return [[name, "std_msgs/Empty"] for name in self.published]


class Counted:
    """A topic, and how often it was asked for."""

    def __init__(self, name: str, publishers: int = 0) -> None:
        self.name, self.publishers, self.times = name, publishers, 0
        self.topic = Subscription(self.make, 0.0)

    def make(self) -> Subscriber:
        self.times += 1
        return Subscriber(self.name, self.publishers)


def test_only_what_somebody_publishes_unheard_is_asked_for_again() -> None:
    """Each question leaves a descriptor, and a robot with the original software tells of plain hits only."""
    heard, unheard, silent = Counted("/heard", publishers=1), Counted("/unheard"), Counted("/silent")
    topics, master = [heard.topic, unheard.topic, silent.topic], Says(["/heard", "/unheard"])
    hear_again(topics, master, UNHEARD / 2)
    assert master.asked == 0, "too early"
    hear_again(topics, master, UNHEARD)
    hear_again(topics, master, UNHEARD * 1.5)
    assert (heard.times, unheard.times, silent.times) == (1, 2, 1)
    hear_again(topics, master, UNHEARD * 2)
    assert (heard.times, unheard.times, silent.times) == (1, 3, 1)


@pytest.mark.parametrize("fault", [OSError("timed out"), MasterError("no"), ValueError("no list")])
def test_nothing_is_asked_for_again_while_the_ros_master_says_nothing(fault: Exception) -> None:
    topic = Counted("/unheard")
    hear_again([topic.topic], Says(fault), UNHEARD)
    assert topic.times == 1
