"""The shots that are fired, on `/shots`, and the hits that robots report: on `/Robot<ID>/response` (std_msgs/Empty) by
plain light, on `/Robot<ID>/hit` by coded light. Needs an initialised node."""

import logging
import threading
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import rospy
from std_msgs.msg import Empty

from laser_bot_battle.master import Master
from laser_bot_battle.msg import Hit, Shot
from laser_bot_battle.names import SHOTS, hit_topic, response_topic
from laser_bot_battle.rospy_cures import Subscription
from server.game.events import Recorded
from server.game.loop import GameLoop
from server.game.place_events import HitRefused
from server.ros.robot_topics import RobotSubscriptions

_log = logging.getLogger(__name__)


class Hits(RobotSubscriptions):
    """Listens to exactly the robots that are registered."""

    def __init__(self, game: GameLoop, master: Master) -> None:
        self._game = game
        self._lock = threading.Lock()
        self._told: Counter[tuple[str, ...]] = Counter(
            {(light, counts): 0 for light in ("plain", "coded") for counts in ("yes", "no")}
        )
        self.refused = 0  # of them by the line of fire
        game.add_recorder(self._record)
        listen = partial(rospy.Subscriber, SHOTS, Shot, self._shot, tcp_nodelay=True)
        self._shots = Subscription(listen, time.monotonic())
        super().__init__(master, self._shots)

    def told(self) -> dict[tuple[str, ...], int]:
        """How many were reported: by light, `plain` or `coded`, and whether they count, `yes` or `no`."""
        with self._lock:
            return dict(self._told)

    def _record(self, journal: Sequence[Recorded], _saved: Mapping[str, Any]) -> None:
        self.refused += sum(isinstance(one.event, HitRefused) for one in journal)

    @property
    def _shots_told(self) -> bool:
        """Whether somebody tells of shots: our rosbridge does, another one does not."""
        return self._shots.is_connected()

    def _open(self, robot_id: int) -> Sequence[Subscription]:
        subscribe = partial(rospy.Subscriber, callback_args=robot_id, tcp_nodelay=True)
        now = time.monotonic()
        return [
            Subscription(partial(subscribe, response_topic(robot_id), Empty, self._hit), now),
            Subscription(partial(subscribe, hit_topic(robot_id), Hit, self._shot_hit), now),
        ]

    def _shot(self, message: Shot) -> None:
        self._game.shot(message.robot)

    def _hit(self, _: Empty, robot_id: int) -> None:
        counted = self._game.hit(robot_id, shots_told=self._shots_told)
        self._count("plain", counted)
        _log.debug("robot %d reports a hit%s", robot_id, "" if counted else ", which does not count")

    def _shot_hit(self, message: Hit, robot_id: int) -> None:
        counted = self._game.shot_hit(robot_id, message.shooter, message.damage, shots_told=self._shots_told)
        self._count("coded", counted)
        by = f"by robot {message.shooter}"
        _log.debug("robot %d reports a hit %s%s", robot_id, by, "" if counted else ", which does not count")

    def _count(self, light: str, counted: bool) -> None:
        with self._lock:  # each robot has its own thread
            self._told[light, "yes" if counted else "no"] += 1
