"""The device's questions for ROS parameters."""

import logging
from collections.abc import Callable

import rospy

from laser_bot_battle.master import Master, MasterError
from robot.rosserial import parameters
from robot.rosserial.frame import OVERHEAD
from robot.task_thread import TaskThread

MAX_QUESTIONS = 8  # that wait; ros_lib asks one at a time, and then for 1 s

_log = logging.getLogger(__name__)


class Parameters:
    """Asks the ROS master, in a thread of its own."""

    def __init__(self, master: Master, send: Callable[[bytes], None]) -> None:
        """`send(frame)`: to the device."""
        self._master = master
        self._send = send
        self._tasks = TaskThread("parameters", MAX_QUESTIONS)

    def ask(self, name: str, room: int) -> None:
        """Have the parameter sent to the device, nothing in place of one that is absent or longer than `room` bytes.

        Questions that come faster than the ROS master answers are dropped.
        """
        self._tasks.do(lambda: self._send(self._answer(name, room)))

    def _answer(self, name: str, room: int) -> bytes:
        try:
            frame = parameters.answer(self._master.call("getParam", rospy.resolve_name(name)))
            if len(frame) > OVERHEAD + room:
                raise ValueError(f"{len(frame)} bytes are more than the device's {room}")
        except (OSError, MasterError, ValueError) as error:
            _log.warning("the device asks for parameter %r and gets none: %s", name, error)
            return parameters.NOTHING
        return frame
