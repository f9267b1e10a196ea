"""What is open in ROS for exactly the robots that are registered. Needs an initialised node."""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import rospy

from server.game.snapshot import Snapshot

# s without a robot's node until its topic is asked for again: rospy forgets a publisher that appears in the moment of
# subscribing, and one that did not answer at once
RETRY = 2.0

Endpoint = Any  # rospy.Publisher or rospy.Subscriber, which are not typed


class RobotTopic:
    """One topic, open until `close`. Opened and closed by one thread, asked and told by any."""

    def __init__(self, make: Callable[[], Endpoint], now: float) -> None:
        self._make, self._since = make, now
        self._lock = threading.Lock()  # rospy's endpoints are good for nothing once they are closed
        self._endpoint: Endpoint | None = make()

    def is_connected(self) -> bool:
        """Whether anybody is at its other end."""
        with self._lock:
            return self._endpoint is not None and self._endpoint.get_num_connections() > 0

    def tell(self, message: Any) -> None:
        """Publish the message, unless the topic is closed."""
        with self._lock:
            if self._endpoint is not None:
                self._endpoint.publish(message)

    def hear_again(self, now: float) -> None:
        """Ask for the topic again if nobody has been heard on it."""
        is_listener = isinstance(self._endpoint, rospy.Subscriber)
        if is_listener and now - self._since >= RETRY and not self.is_connected():
            self.close()
            self._since, self._endpoint = now, self._make()

    def close(self) -> None:
        with self._lock:
            endpoint, self._endpoint = self._endpoint, None
        if endpoint is not None:
            endpoint.unregister()  # asks the ROS master, so that nobody must wait for it


class RobotTopics(ABC):
    """Opening and closing asks the ROS master, which may be slow: that is the work of a thread of its own, `run`."""

    def __init__(self) -> None:
        self._opened: dict[int, Sequence[RobotTopic]] = {}  # by robot
        self._present: tuple[int, ...] = ()
        self._changed = threading.Event()
        self._stopping = False

    def follow(self, snapshot: Snapshot) -> None:
        """A listener of the game; does not block."""
        if snapshot.robots != self._present:
            self._present = snapshot.robots
            self._changed.set()

    def run(self) -> None:
        """Work until `stop`."""
        while not self._stopping:
            self._changed.wait(RETRY)
            self._changed.clear()
            self._settle(self._present)

    def stop(self) -> None:
        self._stopping = True
        self._changed.set()

    def _settle(self, present: Sequence[int]) -> None:
        now = time.monotonic()
        for robot_id in self._opened.keys() - set(present):
            for topic in self._opened.pop(robot_id):
                topic.close()
        for topics in self._opened.values():
            for topic in topics:
                topic.hear_again(now)
        for robot_id in present:
            if robot_id not in self._opened:
                self._opened[robot_id] = [RobotTopic(make, now) for make in self._open(robot_id)]

    @abstractmethod
    def _open(self, robot_id: int) -> Sequence[Callable[[], Endpoint]]:
        """What makes the publishers or subscribers for the robot with this ID."""
