"""ROS nodes for the tests, each a process of its own because rospy knows only one node per process.

python -m tests.integration.server.peers robot NAME URL   registers (NAME "-": without a node name), pings URL; is on
                                                          its topics (but "-"); each SIGUSR1 is a hit
python -m tests.integration.server.peers original URL     as the original's client: registers without a node name and
                                                          pings; its serial node is Robot<ID>
python -m tests.integration.server.peers status           prints /game_status, one JSON object a line
python -m tests.integration.server.peers crowd            registers nameless robots until the server refuses
python -m tests.integration.server.peers register FROM TO [KEY]   registers robots with these numbers as names
python -m tests.integration.server.peers hit ID           reports one hit of robot ID, registered or not
python -m tests.integration.server.peers positions        tells where robots 0 and 1 are: on a floor of 2 m x 1 m, 0
                                                          drives to and fro along x, 1 stands covered in its corner
python -m tests.integration.server.peers board ID SUPPLY  tells the health of robot ID, whose Arduino has so many mV;
                                                          prints its setups, one JSON object a line, and "identify"
python -m tests.integration.server.peers light WHAT...    tells of shots and hits in this order: shot:ROBOT; ten times
                                                          within 0.2 s hit:ROBOT:SHOOTER (coded), response:ROBOT (plain)
"""

import json
import math
import signal
import sys
import time
from collections.abc import Callable

import requests
import rospy
from std_msgs.msg import Empty

from laser_bot_battle.msg import (
    BoardHealth,
    GameStatus,
    Health,
    Hit,
    OverheadCovered,
    Positions,
    Robot_msg,
    RobotPosition,
    Setup,
    Shot,
    UserStatus,
)
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
        publisher = join_topics(robot_id) if name != "-" else None
        signal.signal(signal.SIGUSR1, lambda *_, hits=publisher: hits.publish(Empty()))
        while publisher is not None and publisher.get_num_connections() == 0:
            time.sleep(0.01)
        print("registered", robot_id, flush=True)
        while ping(url, robot_id):
            time.sleep(0.4)


def original(url: str) -> None:
    rospy.wait_for_service("/add_new_robot")
    robot_id = rospy.ServiceProxy("/add_new_robot", AddNewRobot)().ID
    print("registered", robot_id, flush=True)
    rospy.init_node(f"Robot{robot_id}", disable_signals=True)
    publisher = join_topics(robot_id)
    while publisher and ping(url, robot_id):
        time.sleep(0.4)
    print("forgotten", flush=True)


def join_topics(robot_id: int) -> rospy.Publisher:
    """As the serial node of a robot does."""
    rospy.Subscriber(f"/Robot{robot_id}/command", Robot_msg, lambda _: None)
    return rospy.Publisher(f"/Robot{robot_id}/response", Empty, queue_size=10)


def ping(url: str, robot_id: int) -> bool:
    try:
        return requests.post(f"{url}/incAlive", data={"ID": robot_id}, timeout=2).json()["status"] == "OK"
    except requests.ConnectionError:
        return False


def status() -> None:
    def plain(user: UserStatus) -> dict[str, object]:
        return {slot: getattr(user, slot) for slot in user.__slots__}  # or an event, or a place

    def received(message: GameStatus) -> None:
        content = {slot: getattr(message, slot) for slot in message.__slots__}
        content["users"] = [plain(user) for user in message.users]
        content["result"] = [plain(user) for user in message.result]
        content["events"] = [plain(event) for event in message.events]
        content["places"] = [plain(place) for place in message.places]
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


def register(first: str, last: str, key: str = "") -> None:
    """`key` is the digest. These say their address themselves, which nobody must believe."""
    rospy.wait_for_service("/add_new_robot")
    ids: list[int | None] = []
    for number in range(int(first), int(last)):
        headers = {"callerid": f"/id_service_client_{number}", "laserbot_peer": "9.9.9.9"}
        if key:
            headers["laserbot_key"] = key
        try:
            ids.append(rospy.ServiceProxy("/add_new_robot", AddNewRobot, headers=headers)().ID)
        except rospy.ServiceException as error:
            print("refused:", error, flush=True)
            ids.append(None)
    print("ids", json.dumps(ids), flush=True)


def hit(robot_id: str) -> None:
    rospy.init_node("peer_hit", anonymous=True)
    publisher = rospy.Publisher(f"/Robot{robot_id}/response", Empty, queue_size=10, latch=True)
    publisher.publish(Empty())
    print("published", flush=True)
    rospy.spin()


def positions() -> None:
    rospy.init_node("peer_positions", anonymous=True)
    covered = rospy.Publisher("/overhead/covered", OverheadCovered, queue_size=1)
    publisher = rospy.Publisher("/positions", Positions, queue_size=1)
    while not rospy.is_shutdown():
        x = 1 + 0.8 * math.sin(time.monotonic())
        robots = [RobotPosition(0, x, 0.5, 0.0), RobotPosition(1, 1.9, 0.9, math.pi)]
        covered.publish(OverheadCovered([1]))  # again, as it is soon forgotten
        publisher.publish(Positions(2.0, 1.0, [0, 0, 2, 0, 1, 0, 1, 0.3], robots))
        time.sleep(0.1)


def board(robot_id: str, supply: str) -> None:
    def told(setup: Setup) -> None:
        print(json.dumps({slot: getattr(setup, slot) for slot in setup.__slots__}), flush=True)

    rospy.init_node(f"peer_board{robot_id}")
    rospy.Subscriber(f"/Robot{robot_id}/setup", Setup, told)
    rospy.Subscriber(f"/Robot{robot_id}/identify", Empty, lambda _: print("identify", flush=True))
    publisher = rospy.Publisher(f"/Robot{robot_id}/health", Health, queue_size=1)
    health = Health(has_board=True, board=BoardHealth(major=1, supply=int(supply)), cpu=float("nan"), wifi=-60)
    while not rospy.is_shutdown():
        publisher.publish(health)
        time.sleep(0.2)


ROBOT_TOPICS = (("hit", Hit), ("response", Empty))


def light(*words: str) -> None:
    def publisher(topic: str, kind: type) -> rospy.Publisher:
        if topic not in publishers:
            publishers[topic] = rospy.Publisher(topic, kind, queue_size=10)
            wait_for(publishers[topic].get_num_connections)
        return publishers[topic]

    rospy.init_node("peer_light", anonymous=True)
    publishers: dict[str, rospy.Publisher] = {}
    for topic, kind in [("/shots", Shot), *[(f"/Robot{n}/{of}", k) for n in (0, 1) for of, k in ROBOT_TOPICS]]:
        publisher(topic, kind)
    for word in words:
        what, robot_id, *shooter = word.split(":")
        if what == "shot":
            time.sleep(0.5)  # the robots' cooldown
            publisher("/shots", Shot).publish(Shot(int(robot_id)))
            continue
        for _ in range(10):
            time.sleep(0.02)  # the news of shots come by another connection
            if what == "hit":
                publisher(f"/Robot{robot_id}/hit", Hit).publish(Hit(shooter=int(shooter[0]), team=0, damage=5))
            else:
                publisher(f"/Robot{robot_id}/response", Empty).publish(Empty())
    print("done", flush=True)
    rospy.spin()


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + 10
    while not condition():
        if time.monotonic() > end:
            sys.exit("nothing has come of it")
        time.sleep(0.01)


if __name__ == "__main__":
    role, *words = sys.argv[1:]
    roles: dict[str, Callable[..., None]] = {
        "robot": robot,
        "original": original,
        "status": status,
        "crowd": crowd,
        "register": register,
        "hit": hit,
        "positions": positions,
        "board": board,
        "light": light,
    }
    roles[role](*words)
