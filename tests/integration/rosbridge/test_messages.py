"""Messages of Debian's own packages, of every size and in every form, by rosbridge into ROS and back."""

import base64
import json
from collections.abc import Callable
from typing import Any

import pytest

from server.rosbridge.fragments import Reassembly
from server.websocket.requests import Request
from tests.integration.rosbridge.ends import Client

Connect = Callable[..., Client]

STAMP = {"secs": 12, "nsecs": 34}
HEADER = {"seq": 1, "stamp": STAMP, "frame_id": "map"}
VECTOR = {"x": 1.5, "y": -2.0, "z": 0.0}
MESSAGES: dict[str, dict[str, Any]] = {
    "sensor_msgs/LaserScan": {"header": HEADER, "ranges": [0.5, None, 2.0], "angle_min": -1.5},
    "nav_msgs/OccupancyGrid": {"header": HEADER, "info": {"width": 2, "height": 2}, "data": [0, 100, -1, 50]},
    "actionlib_msgs/GoalStatusArray": {
        "header": HEADER, "status_list": [{"goal_id": {"stamp": STAMP, "id": "goal"}, "status": 3, "text": "done"}],
    },
    "tf2_msgs/TFMessage": {
        "transforms": [{"header": HEADER, "child_frame_id": "robot", "transform": {"translation": VECTOR}}],
    },
}  # fmt: skip
IMAGE = {"height": 1, "width": 5 * 2**20, "encoding": "mono8", "data": base64.b64encode(bytes(5 * 2**20)).decode()}


def contains(whole: Any, part: Any) -> bool:
    """Whether `whole` has all that `part` has: what is not given has its default."""
    if isinstance(part, dict):
        return all(contains(whole[name], value) for name, value in part.items())
    if isinstance(part, list):
        return len(whole) == len(part) and all(map(contains, whole, part))
    return bool(whole == part)


@pytest.mark.parametrize("kind", MESSAGES)
def test_messages_of_any_package_come_through(client: Connect, kind: str) -> None:
    speaker, listener = client().operate(), client().operate()
    topic = f"/messages/{kind.partition('/')[2]}"
    listener.say("subscribe", topic=topic, type=kind)
    speaker.say("advertise", topic=topic, type=kind)
    speaker.say("publish", topic=topic, msg=MESSAGES[kind])
    assert contains(listener.hear()["msg"], MESSAGES[kind])


def test_a_message_of_five_megabytes_goes_both_ways(client: Connect) -> None:
    speaker, listener = client().operate(), client().operate()
    listener.say("subscribe", topic="/image", type="sensor_msgs/Image", compression="cbor")
    speaker.say("publish", topic="/image", type="sensor_msgs/Image", msg=IMAGE)
    assert listener.hear_cbor()["msg"]["data"] == bytes(5 * 2**20)


def test_every_form_has_the_same_content(client: Connect) -> None:
    text = "forms " * 100
    speaker = client().operate()
    listeners: dict[str, Client] = {}
    forms: list[dict[str, Any]] = [
        {"compression": "png"}, {"compression": "cbor"}, {"compression": "cbor-raw"}, {"fragment_size": 100},
    ]  # fmt: skip
    for form in forms:
        listener = listeners[str(*form.values())] = client().operate()
        listener.say("subscribe", topic="/forms", type="std_msgs/String", **form)
    speaker.say("advertise", topic="/forms", type="std_msgs/String")
    speaker.say("publish", topic="/forms", msg={"data": text})
    assert listeners["png"].hear()["op"] == "png"
    assert listeners["cbor"].hear_cbor()["msg"] == {"data": text}
    raw = listeners["cbor-raw"].hear_cbor()["msg"]["bytes"]
    assert raw == len(text).to_bytes(4, "little") + text.encode()
    parts = Reassembly()
    whole = None
    while whole is None:
        whole = parts.add(Request(listeners["100"].hear()), 0.0)
    assert json.loads(whole) == {"op": "publish", "topic": "/forms", "msg": {"data": text}}


def test_the_answer_of_a_service_has_the_form_that_was_asked_for(client: Connect) -> None:
    operator = client().operate()
    operator.say("call_service", service="/rosapi/topic_type", args=["/rosout"], compression="cbor", id=1)
    answer = operator.hear_cbor()
    assert (answer["op"], answer["id"], answer["result"]) == ("service_response", 1, True)
