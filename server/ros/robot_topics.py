"""What is open in ROS for exactly the robots that are registered. Needs an initialised node."""

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from typing import Any

import rospy

from laser_bot_battle.master import Master, MasterError
from server.game.snapshot import Snapshot

_log = logging.getLogger(__name__)

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

    @property
    def name(self) -> str:
        """Fully qualified, while it is open."""
        with self._lock:
            return "" if self._endpoint is None else str(self._endpoint.resolved_name)

    def is_unheard(self, now: float) -> bool:
        """Whether it listens, and has not heard anybody for a while."""
        is_listener = isinstance(self._endpoint, rospy.Subscriber)
        return is_listener and now - self._since >= RETRY and not self.is_connected()

    def hear_again(self, now: float) -> None:
        """Ask for the topic anew."""
        self.close()
        self._since, self._endpoint = now, self._make()

    def close(self) -> None:
        with self._lock:
            endpoint, self._endpoint = self._endpoint, None
        if endpoint is not None:
            endpoint.unregister()  # asks the ROS master, so that nobody must wait for it


def hear_again(topics: Iterable[RobotTopic], master: Master, now: float) -> None:
    """Ask anew for the topics on which nobody is heard although somebody publishes there. Not for the others, as those
    of a robot that does not tell of its health: rospy leaves a descriptor to the garbage collector each time."""
    unheard = [topic for topic in topics if topic.is_unheard(now)]
    if not unheard:
        return
    try:
        published = {name for name, _ in master.call("getPublishedTopics", "")}
    except (OSError, MasterError, ValueError) as error:
        _log.debug("the ROS master does not say what is published: %s", error)
        return
    for topic in unheard:
        if topic.name in published:
            topic.hear_again(now)


class RobotTopics(ABC):
    """Opening and closing asks the ROS master, which may be slow: that is the work of a thread of its own, `run`."""

    def __init__(self, master: Master, *common: RobotTopic) -> None:
        """`common`: the topics that are of no single robot."""
        self._master, self._common = master, common
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
        hear_again(chain(self._common, *self._opened.values()), self._master, now)
        for robot_id in present:
            if robot_id not in self._opened:
                self._opened[robot_id] = [RobotTopic(make, now) for make in self._open(robot_id)]

    @abstractmethod
    def _open(self, robot_id: int) -> Sequence[Callable[[], Endpoint]]:
        """What makes the publishers or subscribers for the robot with this ID."""
