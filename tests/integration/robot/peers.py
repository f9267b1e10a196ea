"""ROS nodes for the tests, each a process of its own because rospy knows only one node per process.

python -m tests.integration.robot.peers publish TOPIC PERIOD COUNT LINEAR ANGULAR SHOOT [LINEAR ...]
python -m tests.integration.robot.peers listen TOPIC
python -m tests.integration.robot.peers ids FILE     (serves /add_new_robot, the next ID is read from FILE)
"""

import itertools
import sys
import time
from collections.abc import Callable
from pathlib import Path

import rospy
from std_msgs.msg import Empty

from laser_bot_battle.msg import Robot_msg
from laser_bot_battle.srv import AddNewRobot, AddNewRobotRequest, AddNewRobotResponse


def publish(topic: str, period: str, count: str, *words: str) -> None:
    """Publish COUNT commands, the given ones in turn, every PERIOD s (0: as fast as can be), once somebody listens."""
    fields = iter(map(int, words))
    commands = itertools.cycle([*zip(fields, fields, fields, strict=True)])
    publisher = rospy.Publisher(topic, Robot_msg, queue_size=1, tcp_nodelay=True)
    while publisher.get_num_connections() == 0:
        time.sleep(0.01)
    for number in range(int(count)):
        if number:
            time.sleep(float(period))
        publisher.publish(*next(commands))
    print("published", flush=True)
    rospy.spin()


def listen(topic: str) -> None:
    def received(message: Empty) -> None:
        print("message from", message._connection_header["callerid"], flush=True)

    rospy.Subscriber(topic, Empty, received)
    rospy.spin()


def ids(file: str) -> None:
    def add(request: AddNewRobotRequest) -> AddNewRobotResponse:
        header = request._connection_header
        print(f"asked by {header['callerid']}, with key {header['laserbot_key']}", flush=True)
        text = Path(file).read_text()
        if text == "none":
            raise rospy.ServiceException("no ID is free")
        return AddNewRobotResponse(int(text))

    service = rospy.Service("/add_new_robot", AddNewRobot, add)
    print("ready", flush=True)
    service.spin()


if __name__ == "__main__":
    role, *words = sys.argv[1:]
    rospy.init_node(f"peer_{role}", anonymous=True)
    roles: dict[str, Callable[..., None]] = {"publish": publish, "listen": listen, "ids": ids}
    roles[role](*words)
