"""What is open in ROS for exactly the robots that are registered. Needs an initialised node."""

import threading
import time
from abc import abstractmethod
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any, Generic, TypeVar

import rospy

from laser_bot_battle.master import Master
from laser_bot_battle.rospy_cures import Subscription, hear_again
from server.ros.robots_follower import RobotsFollower

PERIOD = 2.0  # s until the robots that are not heard are asked for again


class Publication:
    """One topic, open until `close`. Opened and closed by one thread, asked and told by any."""

    def __init__(self, publisher: rospy.Publisher) -> None:
        self._lock = threading.Lock()  # a publisher is good for nothing once it is closed
        self._publisher: rospy.Publisher | None = publisher

    def is_connected(self) -> bool:
        """Whether anybody listens."""
        with self._lock:
            return self._publisher is not None and self._publisher.get_num_connections() > 0

    def tell(self, message: Any) -> None:
        """Publish the message, unless the topic is closed."""
        with self._lock:
            if self._publisher is not None:
                self._publisher.publish(message)

    def close(self) -> None:
        with self._lock:
            publisher, self._publisher = self._publisher, None
        if publisher is not None:
            publisher.unregister()  # asks the ROS master, so nobody must have to wait for it


Topic = TypeVar("Topic", Publication, Subscription)


class RobotTopics(RobotsFollower, Generic[Topic]):
    """The topics of each robot: all publications, or all subscriptions."""

    def __init__(self) -> None:
        super().__init__(PERIOD)
        self._opened: dict[int, Sequence[Topic]] = {}  # by robot

    def _settle(self, present: Sequence[int]) -> None:
        for robot_id in self._opened.keys() - set(present):
            for topic in self._opened.pop(robot_id):
                topic.close()
        for robot_id in present:
            if robot_id not in self._opened:
                self._opened[robot_id] = self._open(robot_id)

    @abstractmethod
    def _open(self, robot_id: int) -> Sequence[Topic]:
        """Open the topics of the robot with this ID."""


class RobotSubscriptions(RobotTopics[Subscription]):
    def __init__(self, master: Master, *common: Subscription) -> None:
        """`common`: the topics that are of no single robot."""
        super().__init__()
        self._master, self._common = master, common

    def _settle(self, present: Sequence[int]) -> None:
        super()._settle(present)
        subscriptions: Iterable[Subscription] = chain(self._common, *self._opened.values())
        hear_again(subscriptions, self._master, time.monotonic())
