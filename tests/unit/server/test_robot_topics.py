"""A topic of a robot, asked and told by threads other than the one that closes it."""

import pytest
import rospy

from laser_bot_battle.master import Master, MasterError
from server.ros.robot_topics import RETRY, RobotTopic, hear_again


class Endpoint:
    """As rospy's: good for nothing after `unregister`."""

    def __init__(self) -> None:
        self.impl: list[str] | None = []

    def get_num_connections(self) -> int:
        assert self.impl is not None
        return 1

    def publish(self, message: str) -> None:
        assert self.impl is not None
        self.impl.append(message)

    def unregister(self) -> None:
        self.impl = None


class Listener(rospy.Subscriber):
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
        self.topic = RobotTopic(self.make, 0.0)

    def make(self) -> Listener:
        self.times += 1
        return Listener(self.name, self.publishers)


def test_nobody_is_on_a_topic_that_has_been_closed() -> None:
    endpoint = Endpoint()
    topic = RobotTopic(lambda: endpoint, 0.0)
    assert topic.is_connected()
    topic.tell("hello")
    assert endpoint.impl == ["hello"]
    topic.close()
    assert not topic.is_connected()
    topic.tell("hello")


def test_only_what_somebody_publishes_unheard_is_asked_for_again() -> None:
    """Each question leaves a descriptor, and a robot with the original software tells of plain hits only."""
    heard, unheard, silent = Counted("/heard", publishers=1), Counted("/unheard"), Counted("/silent")
    topics, master = [heard.topic, unheard.topic, silent.topic], Says(["/heard", "/unheard"])
    hear_again(topics, master, RETRY / 2)
    assert master.asked == 0, "too early"
    hear_again(topics, master, RETRY)
    hear_again(topics, master, RETRY * 1.5)
    assert (heard.times, unheard.times, silent.times) == (1, 2, 1)
    hear_again(topics, master, RETRY * 2)
    assert (heard.times, unheard.times, silent.times) == (1, 3, 1)


@pytest.mark.parametrize("fault", [OSError("timed out"), MasterError("no"), ValueError("no list")])
def test_nothing_is_asked_for_again_while_the_ros_master_says_nothing(fault: Exception) -> None:
    topic = Counted("/unheard")
    hear_again([topic.topic], Says(fault), RETRY)
    assert topic.times == 1
