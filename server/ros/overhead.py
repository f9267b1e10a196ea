"""What the tracker of the camera above the floor complains of, on `/overhead/status`."""

import time
from collections.abc import Callable

import rospy

from laser_bot_battle.msg import OverheadStatus
from laser_bot_battle.names import OVERHEAD_STATUS

SILENT = 5.0  # s after which the tracker, which speaks each second, does not run
FORGOTTEN = 600.0  # s after which nobody misses it
MOST, LONGEST = 10, 300  # troubles, and characters of each, that are told


class OverheadTroubles:
    """Thread-safe. The time of `clock` is monotonic, in s."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._heard_at, self._troubles = float("-inf"), list[str]()

    def follow(self) -> None:
        """Needs an initialised node."""
        rospy.Subscriber(OVERHEAD_STATUS, OverheadStatus, self.hear, queue_size=1)

    def hear(self, status: OverheadStatus) -> None:
        self._heard_at, self._troubles = self._clock(), [each[:LONGEST] for each in status.troubles[:MOST]]

    def now(self) -> list[str]:
        """What is wrong and what to do, in English; nothing is if there is no such camera."""
        silence = self._clock() - self._heard_at
        if silence <= SILENT:
            return self._troubles
        if silence <= FORGOTTEN:
            return ["the program that tells where robots are, by the camera above the floor, does not run any more"]
        return []
