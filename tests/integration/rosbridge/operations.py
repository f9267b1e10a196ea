"""Valid rosbridge operations, made by chance: every kind of docs/protocol-browser.md but those that only wrap others.

Names in ROS have the role's name in them, so that it shows there who has used them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from tests.integration.rosbridge.ends import COMMAND_TYPE, STATUS_TYPE

Json = dict[str, Any]

COMMAND = {"linear_x": 1, "angular_z": -1, "shoot": False}
LAYOUT = {"dim": [{"label": "rows", "size": 1, "stride": 2}], "data_offset": 0}
MESSAGES: dict[str, Json] = {
    COMMAND_TYPE: COMMAND,
    STATUS_TYPE: {"game": 2, "time_left": 1.5, "users": [{"name": "al", "robot": 0, "life": 100}], "result": []},
    "std_msgs/Bool": {"data": True},
    "std_msgs/Duration": {"data": {"secs": -1, "nsecs": 5}},
    "std_msgs/Empty": {},
    "std_msgs/Float32": {"data": 0.5},
    "std_msgs/Float64MultiArray": {"layout": LAYOUT, "data": [1.5, None, -2]},
    "std_msgs/Header": {"seq": 1, "stamp": {"secs": 1, "nsecs": 5}, "frame_id": "map"},
    "std_msgs/Int64": {"data": 2**63 - 1},
    "std_msgs/String": {"data": "text"},
    "std_msgs/Time": {"data": "now"},
    "std_msgs/UInt8MultiArray": {"layout": LAYOUT, "data": "AAEC"},
    "rosgraph_msgs/Log": {"level": 2, "name": "/n", "msg": "m", "line": 7, "topics": ["/a", "/b"]},
}
# Services that are there, with arguments for them.
SERVICES: dict[str, Json] = {
    "/add_new_robot": {},
    "/fails": {},
    **{f"/rosapi/{name}": {} for name in ("topics", "topics_and_raw_types", "services", "nodes", "get_param_names")},
    **{f"/rosapi/{name}": {} for name in ("get_time", "action_servers")},
    **{f"/rosapi/{name}": {"topic": "/game_status"} for name in ("topic_type", "publishers", "subscribers")},
    **{f"/rosapi/{name}": {"type": STATUS_TYPE} for name in ("topics_for_type", "message_details")},
    **{f"/rosapi/{name}": {"service": "/fails"} for name in ("service_type", "service_node", "service_host")},
    **{f"/rosapi/service_{name}_details": {"type": "rosapi/TopicType"} for name in ("request", "response")},
    "/rosapi/services_for_type": {"type": "rosapi/TopicType"},
    "/rosapi/service_providers": {"service": "rosapi/TopicType"},
    "/rosapi/node_details": {"node": "/rosapi"},
    "/rosapi/set_param": {"name": "/operator/p", "value": '{"a": [1, 2.5, "x", true]}'},
    "/rosapi/get_param": {"name": "/operator/p", "default": "1"},
    "/rosapi/has_param": {"name": "/operator/p"},
    "/rosapi/search_param": {"name": "p"},
    "/rosapi/delete_param": {"name": "/operator/p"},
}
OFFERED = {"rosapi/GetParam": {"value": "v"}, "laser_bot_battle/AddNewRobot": {"ID": 3}, "std_srvs/Empty": {}}


@dataclass(frozen=True)
class Role:
    """Who sends. `others`: names of ROS that are not this role's, with their types."""

    name: str
    others: tuple[tuple[str, str], ...]
    names: tuple[str, ...]  # for auth
    secrets: tuple[str, ...]

    def topic(self, random: Random) -> tuple[str, str]:
        if random.random() < 0.4:
            return random.choice(self.others)
        kind = random.choice(list(MESSAGES))
        form = random.choice(("/{}/{}", "/{}/{}", "{}/{}", "~{}/{}", "/{}//{}", "/{}/{}/"))
        return form.format(self.name, kind.rpartition("/")[2]), kind

    def offered(self, random: Random) -> tuple[str, str]:
        kind = random.choice(list(OFFERED))
        return f"/{self.name}/service/{kind.rpartition('/')[2]}", kind


def operation(random: Random, role: Role, call: str) -> Json:
    """One of them; `call`: the id of a call that the server waits for, if there is one."""
    made = OPERATIONS[random.choice(list(OPERATIONS))](random, role, call)
    if random.random() < 0.5:
        made.setdefault("id", random.choice((f"{made['op']}:{random.randrange(5)}", random.randrange(5))))
    return made


def _advertise(random: Random, role: Role, _: str) -> Json:
    topic, kind = role.topic(random)
    return {"op": "advertise", "topic": topic, "type": kind, "latch": random.random() < 0.3, "queue_size": 10}


def _publish(random: Random, role: Role, _: str) -> Json:
    topic, kind = role.topic(random)
    message = MESSAGES[kind]
    if kind == COMMAND_TYPE:
        message = {
            "linear_x": random.randint(-1, 1),
            "angular_z": random.randint(-1, 1),
            "shoot": random.random() < 0.5,
        }
    return {"op": "publish", "topic": topic, "msg": message} | ({"type": kind} if random.random() < 0.3 else {})


def _subscribe(random: Random, role: Role, _: str) -> Json:
    topic, kind = role.topic(random)
    terms = {
        "type": kind,
        "throttle_rate": random.choice((0, 0, 1, 1e9)),
        "queue_length": random.choice((0, 1, 1000)),
        "fragment_size": random.choice((1, 100, 10**6)),
        "compression": random.choice(("none", "png", "cbor", "cbor-raw")),
    }
    return {"op": "subscribe", "topic": topic} | {key: terms[key] for key in terms if random.random() < 0.6}


def _call_service(random: Random, role: Role, _: str) -> Json:
    args: Any
    service, args = random.choice(list(SERVICES.items()))
    if random.random() < 0.6:
        service, args = role.offered(random)[0], {}
    form = {"compression": random.choice(("png", "cbor")), "fragment_size": 100} if random.random() < 0.3 else {}
    args = args if random.random() < 0.8 else [*args.values()]
    return {"op": "call_service", "service": service, "args": args, "timeout": 2.0, **form}


def _advertise_service(random: Random, role: Role, _: str) -> Json:
    service, kind = role.offered(random)
    return {"op": "advertise_service", "service": service, "type": kind}


def _service_response(random: Random, role: Role, call: str) -> Json:
    kind = next((kind for kind in OFFERED if kind.rpartition("/")[2] in call), "std_srvs/Empty")
    values = random.choice((OFFERED[kind], OFFERED[kind], "no", "two\nlines", {"data": None}, {"data": math.nan}))
    return {"op": "service_response", "id": call, "values": values, "result": random.random() < 0.7}


def _auth(random: Random, role: Role, _: str) -> Json:
    name = random.choice((*role.names, "operator"))
    return {"op": "auth", "client": name, "mac": random.choice(role.secrets), "rand": "1", "t": 1, "end": 9}


def _only(op: str, **choices: Callable[[Random, Role], Any]) -> Callable[[Random, Role, str], Json]:
    return lambda random, role, _: {"op": op, **{name: choose(random, role) for name, choose in choices.items()}}


def _topic_of(random: Random, role: Role) -> str:
    return role.topic(random)[0]


def _level(random: Random, _: Role) -> str:
    return random.choice(("error", "warning", "info", "none"))


OPERATIONS: dict[str, Callable[[Random, Role, str], Json]] = {
    "advertise": _advertise,
    "unadvertise": _only("unadvertise", topic=_topic_of),
    "publish": _publish,
    "subscribe": _subscribe,
    "unsubscribe": _only("unsubscribe", topic=_topic_of),
    "call_service": _call_service,
    "service_response": _service_response,
    "advertise_service": _advertise_service,
    "unadvertise_service": _only("unadvertise_service", service=lambda random, role: role.offered(random)[0]),
    "auth": _auth,
    "set_level": _only("set_level", level=_level),
    "status": _only(
        "status", level=_level, msg=lambda random, _: random.choice(("hello", "a\nb", "\x1b[2J", "x" * 99))
    ),
}
