"""What is open in ROS for exactly the robots that are registered. Needs an initialised node."""

import threading
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

from server.game.snapshot import Snapshot


class RobotTopics(ABC):
    """Opening and closing asks the ROS master, which may be slow: that is the work of a thread of its own, `run`."""

    def __init__(self) -> None:
        self._opened: dict[int, Sequence[Any]] = {}  # rospy's publishers or subscribers, by robot
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
        while self._changed.wait() and not self._stopping:
            self._changed.clear()
            self._settle(self._present)

    def stop(self) -> None:
        self._stopping = True
        self._changed.set()

    def _settle(self, present: Sequence[int]) -> None:
        for robot_id in self._opened.keys() - set(present):
            for topic in self._opened.pop(robot_id):
                topic.unregister()
        for robot_id in present:
            if robot_id not in self._opened:
                self._opened[robot_id] = self._open(robot_id)

    @abstractmethod
    def _open(self, robot_id: int) -> Sequence[Any]:
        """Publishers or subscribers for the robot with this ID."""
