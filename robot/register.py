"""Asks the server for this robot's ID and prints it: `python3 -m robot.register [KEY]`.

KEY is the digest (SHA-256) of what the robot's pings will show; the robot keeps the key itself to itself.

A process of its own for each question, because rospy cannot be given a time-out. Ends with exit code 1 and one line on
stderr when there is no ID.
"""

import os
import socket
import sys
import time
from urllib.parse import urlsplit

from robot.installed import missing_explained

with missing_explained():
    import rosgraph.network
    import rospy

    from laser_bot_battle.announcement import NoArenaError
    from laser_bot_battle.master import Master, MasterError
    from laser_bot_battle.names import ADD_NEW_ROBOT, KEY_FIELD
    from laser_bot_battle.ros_environment import ros_environment
    from laser_bot_battle.rospy_guard import guard_rospy
    from laser_bot_battle.srv import AddNewRobot
    from robot.master_location import locate_once
    from robot.settings import Settings

WAIT = 4.0  # s for a server that is just starting
CONNECT = 0.5  # s; after a change of address the ROS master may still name the server's old one
POLL = 0.1  # s


def main() -> int:
    settings = Settings.load("robot.register")
    try:
        uri = locate_once(settings).ros_master_uri
    except NoArenaError as error:
        print(error, file=sys.stderr)
        return 1
    guard_rospy()  # also of what answers in the server's place
    try:
        os.environ.update(ros_environment(os.environ, uri))
        wait_for_server(Master(uri, settings.caller_id))
        # the request is empty: the server knows a robot by what stands in the connection header
        headers = {"callerid": settings.caller_id}
        if sys.argv[1:]:
            headers[KEY_FIELD] = sys.argv[1]
        add_new_robot = rospy.ServiceProxy(ADD_NEW_ROBOT, AddNewRobot, headers=headers)
        print(add_new_robot().ID, flush=True)  # who has asked goes on at once
    except (OSError, rospy.ROSException, rospy.ServiceException) as error:
        print(f"Service call failed: {error} (ROS master {uri})", file=sys.stderr)
        return 1
    return 0


def wait_for_server(master: Master) -> None:
    """Until the server takes connections; OSError if it does not within WAIT s.

    Without a ROS master or a server that is registered there, the call itself says best what is wrong.
    """
    end = time.monotonic() + WAIT
    while True:
        lost = None
        try:
            service = urlsplit(master.call("lookupService", ADD_NEW_ROBOT))
            where = (service.hostname or "", service.port or 0)
            lost = f"the server at {where[0]} port {where[1]} does not answer"
            with socket.create_connection(where, CONNECT) as connection:
                header = {"probe": "1", "md5sum": "*", "callerid": master.node, "service": ADD_NEW_ROBOT}
                rosgraph.network.write_ros_handshake_header(connection, header)
            return
        except (OSError, MasterError) as error:
            if time.monotonic() > end:
                if lost:
                    raise OSError(f"{lost}: {error}") from None
                return
        time.sleep(POLL)


if __name__ == "__main__":
    sys.exit(main())
