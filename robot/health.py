"""Tells once a second how this robot is: `~health`, which is /Robot<ID>/health, and /diagnostics."""

import logging
import threading
import time
from collections.abc import Callable

import rospy

from laser_bot_battle.msg import BoardHealth, Health
from robot.diagnostics import Diagnostics, LineState
from robot.pi_readings import PiReadings

PERIOD = 1.0  # s
BOARD_STALE = 3.0  # s; what the Arduino said before is no news of it

_log = logging.getLogger(__name__)


class Board:
    """The last word of the Arduino about itself."""

    def __init__(self) -> None:
        self._last: tuple[float, BoardHealth] | None = None

    def take(self, message: BoardHealth, now: float) -> None:
        """`now`: s of a steady clock."""
        self._last = (now, message)

    def latest(self, now: float) -> BoardHealth | None:
        """None while there is none that is new enough: not with the original sketch."""
        if self._last is None or now - self._last[0] > BOARD_STALE:
            return None
        return self._last[1]


def health(board: BoardHealth | None, pi: PiReadings) -> Health:
    return Health(
        has_board=board is not None,
        board=board or BoardHealth(),
        cpu=pi.cpu(),
        temperature=pi.temperature(),
        wifi=pi.wifi(),
        under_voltage=pi.under_voltage(),
    )


class HealthThread(threading.Thread):
    """Publishes until `stop`; start it in a node of ROS."""

    def __init__(self, board: Board, device: str, state: Callable[[], LineState], pi: PiReadings) -> None:
        super().__init__(name="health", daemon=True)
        self._board = board
        self._state = state
        self._pi = pi
        self._publisher = rospy.Publisher("~health", Health, queue_size=1)
        self._diagnostics = Diagnostics(device)
        self._end = threading.Event()

    def stop(self) -> None:
        self._end.set()

    def run(self) -> None:
        due = time.monotonic()
        while not self._end.wait(max(0.0, due - time.monotonic())):
            due = max(due + PERIOD, time.monotonic())
            try:
                self._publisher.publish(health(self._board.latest(time.monotonic()), self._pi))
                self._diagnostics.publish(self._state())
            except rospy.ROSException as error:  # the node is ending
                _log.debug("health is not told: %s", error)
