"""The ROS service `/add_new_robot` (manual 3.1.2): a robot asks for its ID. Needs an initialised node."""

import threading
from typing import Any

import rospy

from laser_bot_battle.names import ADD_NEW_ROBOT
from laser_bot_battle.srv import AddNewRobot, AddNewRobotResponse
from server.game.loop import GameLoop
from server.store.roster import Roster


class IdServiceServer:
    """Answers from rospy's threads."""

    def __init__(self, game: GameLoop, roster: Roster) -> None:
        self._game = game
        self._roster = roster
        self._saved = game.known_robots()
        self._saving = threading.Lock()
        rospy.Service(ADD_NEW_ROBOT, AddNewRobot, self._add_new_robot)

    def _add_new_robot(self, request: Any) -> AddNewRobotResponse:
        caller = request._connection_header.get("callerid", "")
        robot_id = self._game.add_robot(caller)
        if robot_id is None:
            raise rospy.ServiceException("no ID left: 128 robots are registered")
        self._roster.warn_of_lookalike(caller)
        self._save_roster()
        return AddNewRobotResponse(robot_id)

    def _save_roster(self) -> None:
        with self._saving:
            known = self._game.known_robots()
            if known != self._saved:
                self._roster.save(known)
                self._saved = known
