"""ROS nodes for the tests, each a process of its own because rospy knows only one node per process.

python -m tests.integration.robot.peers publish TOPIC PERIOD COUNT LINEAR ANGULAR SHOOT [LINEAR ...]
python -m tests.integration.robot.peers listen TOPIC
python -m tests.integration.robot.peers show TOPIC TYPE         (prints each message in one line)
python -m tests.integration.robot.peers text TOPIC LENGTH       (publishes one std_msgs/String once somebody listens)
python -m tests.integration.robot.peers setup TOPIC ID TEAM MODE  (latches one)
python -m tests.integration.robot.peers call SERVICE            (of std_srvs/Trigger)
python -m tests.integration.robot.peers serve SERVICE           (of std_srvs/Trigger)
python -m tests.integration.robot.peers ids FILE     (serves /add_new_robot, the next ID is read from FILE)
"""

import itertools
import sys
import time
from collections.abc import Callable
from pathlib import Path

import genpy.message
import rospy
from std_msgs.msg import Empty, String
from std_srvs.srv import Trigger, TriggerResponse

from laser_bot_battle.msg import Robot_msg, Setup
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
    print("subscribed", flush=True)
    rospy.spin()


def show(topic: str, type_name: str) -> None:
    kind = genpy.message.get_message_class(type_name)
    rospy.Subscriber(topic, kind, lambda message: print(" ".join(str(message).split()), flush=True))
    print("subscribed", flush=True)
    rospy.spin()


def text(topic: str, length: str) -> None:
    publisher = rospy.Publisher(topic, String, queue_size=1)
    while publisher.get_num_connections() == 0:
        time.sleep(0.01)
    publisher.publish("x" * int(length))
    print("published", flush=True)
    rospy.spin()


def setup(topic: str, *words: str) -> None:
    robot_id, team, mode = map(int, words)
    publisher = rospy.Publisher(topic, Setup, queue_size=1, latch=True)
    publisher.publish(robot_id, team, mode, 500, 0)
    rospy.spin()


def call(service: str) -> None:
    rospy.wait_for_service(service, 10)
    try:
        print("answer:", " ".join(str(rospy.ServiceProxy(service, Trigger)()).split()), flush=True)
    except rospy.ServiceException as error:
        print("failed:", error, flush=True)


def serve(service: str) -> None:
    rospy.Service(service, Trigger, lambda _: TriggerResponse(True, "from ROS"))
    print("ready", flush=True)
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
    roles: dict[str, Callable[..., None]] = {"publish": publish, "listen": listen, "show": show, "setup": setup}
    roles |= {"text": text, "call": call, "serve": serve, "ids": ids}
    roles[role](*words)
