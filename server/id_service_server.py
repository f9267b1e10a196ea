"""The ROS side of the server (manual 3.1.2): robots register, report hits, and everyone hears the state of the battle.

Needs an initialised node (`rospy.init_node`).
"""

import logging
import threading
from typing import Any

import rospy
from std_msgs.msg import Empty

from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.srv import AddNewRobot, AddNewRobotResponse
from server.battle import Battle
from server.roster import Roster
from server.snapshot import Snapshot

_log = logging.getLogger(__name__)


class IdServiceServer:
    """Service `/add_new_robot`, a subscriber of `/Robot<ID>/response` per robot, and the latched `/game_status`."""

    def __init__(self, battle: Battle, roster: Roster) -> None:
        self._battle = battle
        self._roster = roster
        self._saved = battle.known_robots()
        self._saving = threading.Lock()
        self._following = threading.Lock()
        self._subscribers: dict[int, rospy.Subscriber] = {}
        self._publisher = rospy.Publisher("/game_status", GameStatus, latch=True, queue_size=10)
        battle.add_listener(self._publish)
        battle.add_listener(lambda _: self._follow_robots())
        rospy.Service("/add_new_robot", AddNewRobot, self._add_new_robot)

    def _add_new_robot(self, request: Any) -> AddNewRobotResponse:
        caller = request._connection_header.get("callerid", "")
        robot_id = self._battle.add_robot(caller)
        if robot_id is None:
            raise rospy.ServiceException("no ID left: 128 robots are registered")
        self._roster.doubt(caller)
        self._follow_robots()
        self._save_roster()
        return AddNewRobotResponse(robot_id)

    def _save_roster(self) -> None:
        with self._saving:
            known = self._battle.known_robots()
            if known != self._saved:
                self._roster.save(known)
                self._saved = known

    def _follow_robots(self) -> None:
        """Listen to the hits of exactly the robots that are registered now."""
        with self._following:
            present = self._battle.snapshot().robots
            for robot_id in [robot_id for robot_id in self._subscribers if robot_id not in present]:
                self._subscribers.pop(robot_id).unregister()
            for robot_id in present:
                if robot_id not in self._subscribers:
                    self._subscribers[robot_id] = rospy.Subscriber(
                        f"/Robot{robot_id}/response", Empty, self._hit, robot_id, tcp_nodelay=True
                    )

    def _hit(self, _: Empty, robot_id: int) -> None:
        counted = self._battle.hit(robot_id)
        _log.debug("robot %d reports a hit%s", robot_id, "" if counted else ", which does not count")

    def _publish(self, snapshot: Snapshot) -> None:
        if not rospy.is_shutdown():
            self._publisher.publish(to_message(snapshot))


def to_message(snapshot: Snapshot) -> GameStatus:
    """The wire form of a snapshot, see GameStatus.msg."""
    return GameStatus(
        game=snapshot.game.value,
        time_left=snapshot.time_left,
        battle=snapshot.battle,
        notice=snapshot.notice,
        available_robots=snapshot.available_robots,
        users=[
            UserStatus(
                name=player.name,
                robot=player.robot,
                life=player.life,
                ready=player.ready,
                avatar=player.avatar,
                session=player.session,
            )
            for player in snapshot.players
        ],
        result=[
            UserStatus(
                name=placing.name,
                robot=placing.robot,
                life=placing.life,
                avatar=placing.avatar,
                place=placing.place,
                left=placing.left,
            )
            for placing in snapshot.result
        ],
    )
