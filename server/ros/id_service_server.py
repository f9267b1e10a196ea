"""The ROS service `/add_new_robot` (manual 3.1.2): a robot asks for its ID. Needs an initialised node."""

import re
from typing import Any

import rospy

from laser_bot_battle.addresses import machine_of
from laser_bot_battle.names import ADD_NEW_ROBOT, KEY_FIELD
from laser_bot_battle.rospy_cures import PEER
from laser_bot_battle.srv import AddNewRobot, AddNewRobotResponse
from server.game.loop import GameLoop
from server.store.roster import Roster

_DIGEST = re.compile("[0-9a-f]{64}")


class IdServiceServer:
    """Answers from rospy's threads."""

    def __init__(self, game: GameLoop, roster: Roster) -> None:
        self._game = game
        self._roster = roster
        rospy.Service(ADD_NEW_ROBOT, AddNewRobot, self._add_new_robot)

    def _add_new_robot(self, request: Any) -> AddNewRobotResponse:
        header = request._connection_header
        caller, key = header.get("callerid", ""), header.get(KEY_FIELD, "")
        if key and not _DIGEST.fullmatch(key):
            raise rospy.ServiceException(f"the header field {KEY_FIELD} is no SHA-256 in hexadecimal digits")
        robot_id = self._game.add_robot(caller, key=key, address=machine_of(header[PEER]))
        if robot_id is None:
            raise rospy.ServiceException(
                "no ID left: all 128 are in use, or kept for robots that were here before "
                "(LASERBOT_ROSTER can give one of them to this robot)"
            )
        self._roster.warn_of_lookalike(caller)
        return AddNewRobotResponse(robot_id)
