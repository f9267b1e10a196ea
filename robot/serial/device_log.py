"""The log lines of the sketch: in this node's log, and for everybody in /rosout."""

import logging

import rospy
from rosgraph_msgs.msg import Log

from laser_bot_battle.log import visible

_LEVELS = (  # by the level on the serial line
    (logging.DEBUG, Log.DEBUG),
    (logging.INFO, Log.INFO),
    (logging.WARNING, Log.WARN),
    (logging.ERROR, Log.ERROR),
    (logging.CRITICAL, Log.FATAL),
)

_log = logging.getLogger("robot.arduino")


class DeviceLogger:
    def __init__(self) -> None:
        self._rosout = rospy.Publisher("/rosout", Log, queue_size=100)

    def log(self, level: int, text: str) -> None:
        """`level` as on the serial line; one that the protocol does not know is the highest."""
        ours, ros = _LEVELS[min(level, len(_LEVELS) - 1)]
        _log.log(ours, "%s", text)
        line = Log(level=ros, name=rospy.get_name(), msg=visible(text), file="Arduino")
        line.header.stamp = rospy.Time.now()
        self._rosout.publish(line)
