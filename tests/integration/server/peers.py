"""ROS nodes for the tests, each a process of its own because rospy knows only one node per process.

python -m tests.integration.server.peers robot NAME URL   registers (NAME "-": without a node name), pings URL; each
                                                          SIGUSR1 is a hit
python -m tests.integration.server.peers status           prints /game_status, one JSON object a line
python -m tests.integration.server.peers crowd            registers nameless robots until the server refuses
python -m tests.integration.server.peers hit ID           reports one hit of robot ID, registered or not
"""

import json
import signal
import sys
import time
from collections.abc import Callable

import requests
import rospy
from std_msgs.msg import Empty

from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.srv import AddNewRobot


def robot(name: str, url: str) -> None:
    if name != "-":
        rospy.init_node(f"id_service_client_{name}")
    register = rospy.ServiceProxy("/add_new_robot", AddNewRobot)
    while True:
        rospy.wait_for_service("/add_new_robot")
        try:
            robot_id = register().ID
        except rospy.ServiceException:  # the master still names a server that has just been killed
            time.sleep(0.1)
            continue
        publisher = rospy.Publisher(f"/Robot{robot_id}/response", Empty, queue_size=10) if name != "-" else None
        signal.signal(signal.SIGUSR1, lambda *_, hits=publisher: hits.publish(Empty()))
        while publisher is not None and publisher.get_num_connections() == 0:
            time.sleep(0.01)
        print("registered", robot_id, flush=True)
        while ping(url, robot_id):
            time.sleep(0.4)


def ping(url: str, robot_id: int) -> bool:
    try:
        return requests.post(f"{url}/incAlive", data={"ID": robot_id}, timeout=2).json()["status"] == "OK"
    except requests.ConnectionError:
        return False


def status() -> None:
    def plain(user: UserStatus) -> dict[str, object]:
        return {slot: getattr(user, slot) for slot in user.__slots__}

    def received(message: GameStatus) -> None:
        content = {slot: getattr(message, slot) for slot in message.__slots__}
        content["users"] = [plain(user) for user in message.users]
        content["result"] = [plain(user) for user in message.result]
        print(json.dumps(content), flush=True)

    rospy.init_node("peer_status", anonymous=True)
    rospy.Subscriber("/game_status", GameStatus, received, tcp_nodelay=True)
    rospy.spin()


def crowd() -> None:
    rospy.wait_for_service("/add_new_robot")
    register = rospy.ServiceProxy("/add_new_robot", AddNewRobot)
    ids = []
    try:
        while True:
            ids.append(register().ID)
    except rospy.ServiceException as error:
        print("refused after", json.dumps(ids), error, flush=True)


def hit(robot_id: str) -> None:
    rospy.init_node("peer_hit", anonymous=True)
    publisher = rospy.Publisher(f"/Robot{robot_id}/response", Empty, queue_size=10, latch=True)
    publisher.publish(Empty())
    print("published", flush=True)
    rospy.spin()


if __name__ == "__main__":
    role, *words = sys.argv[1:]
    roles: dict[str, Callable[..., None]] = {"robot": robot, "status": status, "crowd": crowd, "hit": hit}
    roles[role](*words)
