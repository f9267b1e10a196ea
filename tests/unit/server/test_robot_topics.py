"""A topic of a robot, asked and told by threads other than the one that closes it."""

from server.ros.robot_topics import Publication


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


def test_nobody_is_on_a_topic_that_has_been_closed() -> None:
    endpoint = Endpoint()
    topic = Publication(endpoint)
    assert topic.is_connected()
    topic.tell("hello")
    assert endpoint.impl == ["hello"]
    topic.close()
    assert not topic.is_connected()
    topic.tell("hello")
