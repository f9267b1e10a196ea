"""The ROS side of rosbridge in the tests, a process of its own: referee, robots and services, driven by JSON lines.

stdin: {"status": {fields of GameStatus}} publishes /game_status, {"publish": [topic, type, {fields}]} publishes once,
{"listen": [topic, type]} subscribes. stdout: {"ready": true} once, {"listens": topic} once it has subscribed,
{"heard": [topic, {fields}]} per message.
"""

import json
import sys
import threading
import time
from typing import Any

import genpy
import roslib.message
import rospy
from std_srvs.srv import Trigger, TriggerResponse

from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.rospy_cures import latched_publisher
from laser_bot_battle.srv import AddNewRobot


def main() -> None:
    rospy.init_node("ros_side", anonymous=True, disable_signals=True)
    lock = threading.Lock()
    publishers: dict[str, rospy.Publisher] = {}
    subscribers: list[rospy.Subscriber] = []

    def say(**line: Any) -> None:
        with lock:
            print(json.dumps(line), flush=True)

    def fails(_: Any) -> None:
        raise rospy.ServiceException("no robot is left")

    def slow(_: Any) -> int:
        time.sleep(3)  # what this service is for: its callers wait less long
        return 1

    def publish(topic: str, kind: type, message: Any, latch: bool) -> None:
        if topic not in publishers:
            make = latched_publisher if latch else rospy.Publisher
            publishers[topic] = make(topic, kind, queue_size=100)
        publishers[topic].publish(message)

    for name, answer in {"/add_new_robot": lambda _: 7, "/fails": fails, "/slow": slow}.items():
        rospy.Service(name, AddNewRobot, answer)
    rospy.Service("/long_answer", Trigger, lambda _: TriggerResponse(True, "long " * 300_000))
    say(ready=True)
    for text in sys.stdin:
        line = json.loads(text)
        if "status" in line:
            fields = line["status"]
            users = [UserStatus(**user) for user in fields.pop("users", [])]
            publish("/game_status", GameStatus, GameStatus(users=users, **fields), True)
        elif "publish" in line:
            topic, kind, fields = line["publish"]
            kind = roslib.message.get_message_class(kind)
            publish(topic, kind, kind(**fields), False)
        else:
            topic, kind = line["listen"]
            kind = roslib.message.get_message_class(kind)

            def heard(message: Any, topic: str = topic) -> None:
                say(heard=[topic, plain(message)])

            subscribers.append(rospy.Subscriber(topic, kind, heard, tcp_nodelay=True))
            say(listens=topic)
    rospy.signal_shutdown("the test is over")


def plain(value: Any) -> Any:
    """As JSON has it; times are in s."""
    if isinstance(value, genpy.Message):
        return {field: plain(getattr(value, field)) for field in value.__slots__}
    if isinstance(value, genpy.Time):
        return value.to_sec()
    return [plain(each) for each in value] if isinstance(value, list | tuple) else value


if __name__ == "__main__":
    main()
