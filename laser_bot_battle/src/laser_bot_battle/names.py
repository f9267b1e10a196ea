"""The names and ports by which the parts of the system find each other: the contract (docs/protocol-ros.md,
docs/protocol-browser.md)."""

import hashlib
import hmac
import re
from enum import IntEnum

VERSION = "1.0.0"  # of the whole system

MASTER_HOST = "laser_bot_master.local"
MASTER_HOST_ALIAS = "laser-bot-master.local"  # DNS proper knows no underscores
WEB_PORT = 5000
ROSBRIDGE_PORT = 9090
ROS_PORT = 11311
ROSSERIAL_PORT = 11411  # where boards with Wi-Fi connect, as with upstream's rosserial_server
RELAY_PORT = 9091  # of the cameras' relay
ENTRANCE_PORT = 5010  # of the page that leads to several arenas
CAMERA_STREAM_PORT = 8090  # on a robot
# programs that tell how they are, each on a port of its own, in this order (docs/monitoring.md)
WATCHED = ("web", "rosbridge", "relay", "arena", "overhead")
METRICS_PORT = 9200  # of the first of them, with compose

SERVER_NODE = "robots_server"
ROSBRIDGE_NODE = "rosbridge_websocket"
ROSAPI_NODE = "rosapi"
RELAY_NODE = "camera_relay"
ROSOUT_NODE = "rosout"
POSITIONS_NODE = "arena_positions"
OVERHEAD_NODE = "overhead_tracker"
ADD_NEW_ROBOT = "/add_new_robot"
GAME_STATUS = "/game_status"
POSITIONS = "/positions"
OVERHEAD_STATUS = "/overhead/status"
OVERHEAD_VIEW = "/overhead/view"
OVERHEAD_COVERED = "/overhead/covered"
OVERHEAD_CAMERA = "/overhead/camera"
SHOTS = "/shots"

KEY_FIELD = "laserbot_key"  # of the connection header in which a robot registers: the digest of its key

ROBOT_IDS = range(128)  # what fits the int8 of AddNewRobot.srv
ABOVE = 255  # stands for a robot's ID where the camera above the floor is meant (docs/protocol-camera.md)

# with which the relay asks for a camera's pictures: no page can send it to another origin
RELAY_HEADER = "X-Laserbot-Relay"
# of each picture of a camera that can be asked for fewer than so many a second, by `rate` in the query
RATE_HEADER = "X-Laserbot-Rate"
# of a request that came by the front: all of the game is below one address (server/front)
FRONT_HEADER = "X-Laserbot-Front"
SESSION_COOKIE = "laserbot_session"
# By https. With one name for both, a page by http could neither read the cookie that one by https has given, at any
# port of the host or in the domain that arenas share, nor put its own in its place: nobody could sign up there.
SECURE_SESSION_COOKIE = "__Secure-laserbot_session"
SESSION_COOKIES = (SECURE_SESSION_COOKIE, SESSION_COOKIE)  # a browser sends both to a page by https
TICKET_LIFE = 60  # s
OPERATOR_TICKET_LIFE = 20  # s

_CLIENT = "/id_service_client_"


BOT_PREFIX = "Bot"
_BOT = re.compile(BOT_PREFIX + r"[0-9]{1,13}")  # at most 16 letters, like every player's


class Game(IntEnum):
    """The states of the game, as the constants of GameStatus.msg, whose generated class needs ROS."""

    STOPPED = 0
    COUNTDOWN = 1
    PLAYING = 2


def is_bot(name: str) -> bool:
    """Whether a player of this name is a bot: Bot1 is one, Botond is a person."""
    return _BOT.fullmatch(name) is not None


def robot_node(robot_id: int) -> str:
    return f"Robot{robot_id}"


def command_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/command"


def response_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/response"


def hit_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/hit"


def setup_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/setup"


def health_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/health"


def identify_topic(robot_id: int) -> str:
    return f"/{robot_node(robot_id)}/identify"


def camera_parameter(robot_id: int) -> str:
    """The ROS parameter that tells where the robot's camera is: http://host:port/path."""
    return f"/{robot_node(robot_id)}/camera"


def client_name(robot_name: str) -> str:
    """The ROS name under which a robot calls `/add_new_robot`: the server tells robots apart by it."""
    return _CLIENT + re.sub(r"[^A-Za-z0-9_]", "_", robot_name)


def robot_name(client: str) -> str:
    """The robot's name within its client's, for people."""
    return client.removeprefix(_CLIENT)


def key_digest(key: str) -> str:
    """What stands for a robot's key (docs/protocol-ros.md) where others can read it: its SHA-256 (hex)."""
    return _sha256(key)


def session_digest(token: str) -> str:
    """What stands for a player's session token where others can read it: its SHA-256 (hex)."""
    return _sha256(token)


def session_ticket(digest: str, now: float) -> str:
    """What a page, which cannot read its own cookie, shows in place of the session token: valid for `TICKET_LIFE`.

    `digest` is the session's, which only the master's programs know; `now` is Unix time in s.
    """
    return _ticket(digest, int(now) + TICKET_LIFE)


def is_session_ticket(ticket: str, digest: str, now: float) -> bool:
    """Whether that is a ticket of this session that is still valid."""
    return _is_ticket(ticket, digest, now)


def operator_ticket(token: str, now: float) -> str:
    """By which the operator's page, which has not the `token` itself, signs in to rosbridge within
    `OPERATOR_TICKET_LIFE`."""
    return _ticket(f"operator {token}", int(now) + OPERATOR_TICKET_LIFE)


def is_operator_ticket(ticket: str, token: str, now: float) -> bool:
    """Whether that is a ticket of the operator with this token that is still valid."""
    return _is_ticket(ticket, f"operator {token}", now)


def _is_ticket(ticket: str, key: str, now: float) -> bool:
    end = ticket.partition(".")[0]
    if not re.fullmatch(r"[0-9]{1,12}", end) or int(end) < now:
        return False
    return hmac.compare_digest(ticket.encode("utf-8", "replace"), _ticket(key, int(end)).encode())


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()


def _ticket(key: str, end: int) -> str:
    proof = hmac.new(key.encode("utf-8", "replace"), f"ticket until {end}".encode(), hashlib.sha256)
    return f"{end}.{proof.hexdigest()}"
