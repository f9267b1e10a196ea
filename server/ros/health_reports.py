"""How the robots are, on `/Robot<ID>/health`. Needs an initialised node."""

import math
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import rospy

from laser_bot_battle.master import Master
from laser_bot_battle.msg import Health
from laser_bot_battle.names import health_topic
from laser_bot_battle.rospy_cures import Subscription
from server.game.robot_health import Report, RobotsHealth
from server.ros.robot_topics import RobotSubscriptions


class HealthListener(RobotSubscriptions):
    """Listens to exactly the robots that are registered."""

    def __init__(self, health: RobotsHealth, master: Master) -> None:
        super().__init__(master)
        self._health = health

    def _open(self, robot_id: int) -> Sequence[Subscription]:
        self._health.forget(robot_id)
        subscribe = partial(rospy.Subscriber, health_topic(robot_id), Health, self._hear, robot_id, queue_size=1)
        return [Subscription(subscribe, time.monotonic())]

    def _hear(self, message: Health, robot_id: int) -> None:
        self._health.report(robot_id, to_report(message))


def to_report(message: Health) -> Report:
    """In JSON's types, which know neither NaN nor infinity; `board` is None if the Arduino says nothing."""
    report = {name: _plain(getattr(message, name)) for name in ("cpu", "temperature", "wifi", "under_voltage")}
    board = message.board
    return {**report, "board": {name: getattr(board, name) for name in board.__slots__} if message.has_board else None}


def _plain(value: Any) -> Any:
    return 0.0 if isinstance(value, float) and not math.isfinite(value) else value
