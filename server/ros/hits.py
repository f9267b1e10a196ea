"""The hits that robots report on `/Robot<ID>/response` (std_msgs/Empty). Needs an initialised node."""

import logging
import threading
import time

import rospy
from std_msgs.msg import Empty

from laser_bot_battle.names import response_topic
from server.game.loop import GameLoop
from server.game.snapshot import Snapshot

_log = logging.getLogger(__name__)

# s without a robot's node until its topic is asked for again: rospy forgets a publisher that appears in the moment of
# subscribing, and one that did not answer at once
RETRY = 2.0


class Hits:
    """Listens to exactly the robots that are registered.

    Subscribing asks the ROS master, which may be slow: that is the work of a thread of its own, `run`.
    """

    def __init__(self, game: GameLoop) -> None:
        self._game = game
        self._subscribers: dict[int, tuple[rospy.Subscriber, float]] = {}  # each with the time of its beginning
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
            self._subscribe(self._present, time.monotonic())

    def stop(self) -> None:
        self._stopping = True
        self._changed.set()

    def _subscribe(self, present: tuple[int, ...], now: float) -> None:
        for robot_id, (subscriber, since) in list(self._subscribers.items()):
            is_deaf = now - since >= RETRY and not subscriber.get_num_connections()
            if robot_id not in present or is_deaf:
                del self._subscribers[robot_id]
                subscriber.unregister()
        for robot_id in present:
            if robot_id not in self._subscribers:
                subscriber = rospy.Subscriber(response_topic(robot_id), Empty, self._hit, robot_id, tcp_nodelay=True)
                self._subscribers[robot_id] = subscriber, now

    def _hit(self, _: Empty, robot_id: int) -> None:
        counted = self._game.hit(robot_id)
        _log.debug("robot %d reports a hit%s", robot_id, "" if counted else ", which does not count")
