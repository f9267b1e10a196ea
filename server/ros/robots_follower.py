"""Work that follows the robots that are registered, in a thread of its own because the ROS master may be slow."""

import threading
from abc import ABC, abstractmethod
from collections.abc import Sequence

from server.game.snapshot import Snapshot


class RobotsFollower(ABC):
    """Settles what belongs to the robots whenever they change, and every `period` s."""

    def __init__(self, period: float) -> None:
        self._period = period
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
            self._changed.wait(self._period)
            self._changed.clear()
            self._settle(self._present)

    def stop(self) -> None:
        self._stopping = True
        self._changed.set()

    @abstractmethod
    def _settle(self, present: Sequence[int]) -> None:
        """Do what is to be done for exactly these robots."""
