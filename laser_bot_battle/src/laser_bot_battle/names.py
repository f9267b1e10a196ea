"""The names and ports by which the parts of the system find each other: the contract (docs/protocol-ros.md,
docs/protocol-browser.md)."""

import hashlib
import re
from enum import IntEnum

MASTER_HOST = "laser_bot_master.local"
WEB_PORT = 5000
ROSBRIDGE_PORT = 9090
ROS_PORT = 11311

SERVER_NODE = "robots_server"
ROSBRIDGE_NODE = "rosbridge_websocket"
ADD_NEW_ROBOT = "/add_new_robot"
GAME_STATUS = "/game_status"

ROBOT_IDS = range(128)  # what fits the int8 of AddNewRobot.srv

SESSION_COOKIE = "laserbot_session"

_CLIENT = "/id_service_client_"


class Game(IntEnum):
    """The states of the game, as the constants of GameStatus.msg, whose generated class needs ROS."""

    STOPPED = 0
    COUNTDOWN = 1
    PLAYING = 2


def robot_node(robot_id: int) -> str:
    return f"Robot{robot_id}"


def command_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/command"


def response_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/response"


def client_name(robot_name: str) -> str:
    """The ROS name under which a robot calls `/add_new_robot`: the server tells robots apart by it."""
    return _CLIENT + re.sub(r"[^A-Za-z0-9_]", "_", robot_name)


def robot_name(client: str) -> str:
    """The robot's name within its client's, for people."""
    return client.removeprefix(_CLIENT)


def session_digest(token: str) -> str:
    """What stands for a player's session token where others can read it: its SHA-256 (hex)."""
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()
