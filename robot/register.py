"""Asks the server for this robot's ID and prints it: `python3 -m robot.register`.

A process of its own for each question, because rospy cannot be given a time-out. Ends with exit code 1 and one line on
stderr when there is no ID.
"""

import contextlib
import os
import sys

from robot.installed import missing_explained

with missing_explained():
    import rospy

    from laser_bot_battle.names import ADD_NEW_ROBOT
    from laser_bot_battle.srv import AddNewRobot
    from robot.ros_environment import ros_environment
    from robot.settings import Settings

WAIT = 4.0  # s for a server that is just starting


def main() -> int:
    settings = Settings.load("robot.register")
    try:
        os.environ.update(ros_environment(os.environ, settings.ros_master_uri))
        with contextlib.suppress(rospy.ROSException):  # the call itself says better what is wrong
            rospy.wait_for_service(ADD_NEW_ROBOT, WAIT)
        # the request is empty: the server knows a robot by the caller's name in the connection header
        add_new_robot = rospy.ServiceProxy(ADD_NEW_ROBOT, AddNewRobot, headers={"callerid": settings.caller_id})
        print(add_new_robot().ID)
    except (OSError, rospy.ROSException, rospy.ServiceException) as error:
        print(f"Service call failed: {error} (ROS master {settings.ros_master_uri})", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
