"""rosapi as operators ask it, over the WebSocket."""

import json
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import Client, RosSide
from tests.support.polling import until
from tests.support.ros import RosMaster

ADD_NEW_ROBOT = "laser_bot_battle/AddNewRobot"
ALL_SERVICES = """
    action_servers delete_param get_param get_param_names get_time has_param message_details node_details nodes
    publishers search_param service_host service_node service_providers service_request_details
    service_response_details service_type services services_for_type set_param subscribers topic_type topics
    topics_and_raw_types topics_for_type
"""


class Rosapi:
    """An operator who asks rosapi, all of whose services are there."""

    def __init__(self, client: Client) -> None:
        self._client = client.operate()
        until(self._is_registered, what="rosapi's services")

    def ask(self, service: str, /, **args: Any) -> dict[str, Any]:
        """The response of a service."""
        answer = self._call(service, args)
        assert answer["result"], answer
        return dict(answer["values"])

    def refuses(self, service: str, /, **args: Any) -> str:
        """Why there is no response."""
        answer = self._call(service, args)
        assert not answer["result"], answer
        return str(answer["values"])

    def _is_registered(self) -> bool:
        answer = self._call("services", {})
        own = {f"/rosapi/{name}" for name in ALL_SERVICES.split()}
        return bool(answer["result"]) and own <= {*answer["values"]["services"]}

    def _call(self, service: str, args: dict[str, Any]) -> dict[str, Any]:
        self._client.say("call_service", service=f"/rosapi/{service}", args=args)
        while (answer := self._client.hear(10))["op"] != "service_response":
            pass
        return answer


@pytest.fixture
def rosapi(client: Callable[..., Client]) -> Rosapi:
    return Rosapi(client())


@pytest.fixture
def with_globs(own_master: RosMaster) -> Iterator[Rosapi]:
    """Of a rosbridge that shows names that begin with /open only."""
    own_master.start()
    globs = {f"LASERBOT_{kind}_GLOB": "/open*" for kind in ("TOPICS", "SERVICES", "PARAMS")}
    rosbridge = Rosbridge(own_master, **globs)
    try:
        rosbridge.program.wait_for("listening")
        with Client(rosbridge.port) as client:
            yield Rosapi(client)
    finally:
        rosbridge.program.stop()


def test_topics_are_told_with_their_types_and_nodes(ros: RosSide, rosapi: Rosapi) -> None:
    ros.publish("/spoken", "std_msgs/String", data="hello")
    ros.listen("/only/heard", "std_msgs/Empty")
    until(lambda: {"/spoken", "/only/heard"} <= set(rosapi.ask("topics")["topics"]))
    topics = rosapi.ask("topics_and_raw_types")
    told = dict(zip(topics["topics"], zip(topics["types"], topics["typedefs_full_text"], strict=True), strict=True))
    assert told["/spoken"][0] == "std_msgs/String" and "string data" in told["/spoken"][1]
    assert told["/only/heard"][0] == "std_msgs/Empty"
    assert rosapi.ask("topic_type", topic="/spoken") == {"type": "std_msgs/String"}
    assert "/only/heard" in rosapi.ask("topics_for_type", type="std_msgs/Empty")["topics"]
    (speaker,) = rosapi.ask("publishers", topic="/spoken")["publishers"]
    assert rosapi.ask("subscribers", topic="/only/heard") == {"subscribers": [speaker]}
    assert {speaker, "/rosapi", "/rosbridge_websocket"} <= set(rosapi.ask("nodes")["nodes"])
    details = rosapi.ask("node_details", node=speaker)
    assert "/spoken" in details["publishing"] and "/only/heard" in details["subscribing"]
    assert "/add_new_robot" in details["services"]


def test_services_are_told_with_their_types_and_nodes(ros: RosSide, rosapi: Rosapi) -> None:
    services = rosapi.ask("services")["services"]
    assert services == sorted(services)
    assert {f"/rosapi/{name}" for name in ALL_SERVICES.split()} == {
        name for name in services if name.startswith("/rosapi/")
    }
    assert rosapi.ask("service_type", service="/add_new_robot") == {"type": ADD_NEW_ROBOT}
    assert rosapi.ask("service_type", service="/rosapi/topics") == {"type": "rosapi/Topics"}
    assert rosapi.ask("services_for_type", type=ADD_NEW_ROBOT) == {"services": ["/add_new_robot", "/fails", "/slow"]}
    (provider,) = rosapi.ask("service_providers", service=ADD_NEW_ROBOT)["providers"]
    assert rosapi.ask("service_node", service="/add_new_robot") == {"node": provider}
    assert rosapi.ask("service_host", service="/add_new_robot") == {"host": "127.0.0.1"}


def test_a_node_that_hangs_does_not_hide_the_services_of_others(ros: RosSide, rosapi: Rosapi) -> None:
    ros.freeze(True)
    try:
        assert rosapi.ask("services_for_type", type="rosapi/Topics") == {"services": ["/rosapi/topics"]}
    finally:
        ros.freeze(False)


@pytest.mark.parametrize(
    ("name", "args", "answer"),
    [
        ("topic_type", {"topic": "/nowhere"}, {"type": ""}),
        ("topics_for_type", {"type": "no/Such"}, {"topics": []}),
        ("publishers", {"topic": ""}, {"publishers": []}),
        ("subscribers", {"topic": "/nowhere"}, {"subscribers": []}),
        ("service_type", {"service": "/nowhere"}, {"type": ""}),
        ("services_for_type", {"type": ""}, {"services": []}),
        ("service_providers", {"service": "no/Such"}, {"providers": []}),
        ("service_node", {"service": "/nowhere"}, {"node": ""}),
        ("service_host", {"service": ""}, {"host": ""}),
        ("node_details", {"node": "/nobody"}, {"subscribing": [], "publishing": [], "services": []}),
        ("has_param", {"name": "/nothing"}, {"exists": False}),
        ("search_param", {"name": "nothing"}, {"global_name": ""}),
        ("search_param", {"name": ""}, {"global_name": ""}),
        ("delete_param", {"name": "/nothing"}, {}),
        ("get_param", {"name": "/nothing"}, {"value": "null"}),
        ("get_param", {"name": "/nothing", "default": '{"a": 1}'}, {"value": '{"a": 1}'}),
        ("get_param", {"name": "/nothing", "default": "no JSON"}, {"value": '"no JSON"'}),
    ],
)
def test_what_nobody_knows_is_empty(rosapi: Rosapi, name: str, args: dict[str, str], answer: dict[str, Any]) -> None:
    assert rosapi.ask(name, **args) == answer


def test_an_action_server_is_known_by_its_topics(ros: RosSide, rosapi: Rosapi) -> None:
    for part in ("goal", "cancel", "status", "feedback", "result"):
        assert "/arm/move" not in rosapi.ask("action_servers")["action_servers"]
        ros.listen(f"/arm/move/{part}", "std_msgs/Empty")
    until(lambda: rosapi.ask("action_servers") == {"action_servers": ["/arm/move"]})


def test_parameters_are_set_found_and_deleted(rosapi: Rosapi) -> None:
    assert rosapi.ask("set_param", name="/robot", value='{"wheels": [2, 2.5], "name": "Käfer", "on": true}') == {}
    assert json.loads(rosapi.ask("get_param", name="robot")["value"]) == {
        "wheels": [2, 2.5],
        "name": "Käfer",
        "on": True,
    }
    assert rosapi.ask("get_param", name="/robot/wheels", default="1") == {"value": "[2, 2.5]"}
    assert rosapi.ask("has_param", name="/robot/on") == {"exists": True}
    assert rosapi.ask("search_param", name="robot") == {"global_name": "/robot"}
    assert "/robot/name" in rosapi.ask("get_param_names")["names"]
    assert "robot" in json.loads(rosapi.ask("get_param", name="")["value"])
    assert rosapi.ask("set_param", name="~own", value="1") == {}
    assert rosapi.ask("get_param", name="/rosapi/own") == {"value": "1"}
    assert rosapi.ask("delete_param", name="/robot") == {}
    assert rosapi.ask("has_param", name="/robot/on") == {"exists": False}


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("/robot", "a word", "a string needs quotes"),
        ("/robot", "null", "delete the parameter"),
        ("/robot", "3000000000", "32 bits"),
        ("/ro\0bot", "1", "control characters"),
        ("/", "1", "root"),
    ],
)
def test_what_cannot_be_a_parameter_is_refused(rosapi: Rosapi, name: str, value: str, reason: str) -> None:
    assert reason in rosapi.refuses("set_param", name=name, value=value)
    assert rosapi.ask("has_param", name="/robot") == {"exists": False}


def test_types_are_told(rosapi: Rosapi) -> None:
    command, *_ = rosapi.ask("message_details", type="laser_bot_battle/Robot_msg")["typedefs"]
    assert command == {
        "type": "laser_bot_battle/Robot_msg",
        "fieldnames": ["linear_x", "angular_z", "shoot"],
        "fieldtypes": ["int8", "int8", "bool"],
        "fieldarraylen": [-1, -1, -1],
        "examples": ["0", "0", "False"],
        "constnames": [],
        "constvalues": [],
    }
    (request,) = rosapi.ask("service_request_details", type=ADD_NEW_ROBOT)["typedefs"]
    (response,) = rosapi.ask("service_response_details", type=ADD_NEW_ROBOT)["typedefs"]
    assert (request["fieldnames"], response["fieldnames"]) == ([], ["ID"])
    for service in ("message_details", "service_request_details", "service_response_details"):
        assert "no/Such" in rosapi.refuses(service, type="no/Such")


def test_the_time_is_ros_s(rosapi: Rosapi) -> None:
    now = rosapi.ask("get_time")["time"]
    assert abs(now["secs"] + now["nsecs"] / 1e9 - time.time()) < 5


def test_guests_may_not_ask(client: Callable[..., Client]) -> None:
    guest = client()
    guest.say("call_service", service="/rosapi/topics")
    assert "only operators" in guest.hear_error()


def test_what_the_globs_hide_is_not_there(with_globs: Rosapi) -> None:
    rosapi = with_globs
    assert rosapi.ask("topics") == {"topics": [], "types": []}
    assert rosapi.ask("topic_type", topic="/game_status") == {"type": ""}
    assert rosapi.ask("publishers", topic="/game_status") == {"publishers": []}
    assert "may not be changed" in rosapi.refuses("set_param", name="/hidden", value="1")
    assert rosapi.ask("set_param", name="/open/x", value="1") == {}
    assert rosapi.ask("get_param_names") == {"names": ["/open/x"]}
    assert rosapi.ask("get_param", name="/", default="7") == {"value": "7"}
    assert rosapi.ask("search_param", name="rosbridge_websocket") == {"global_name": ""}
    assert "may not be changed" in rosapi.refuses("delete_param", name="rosbridge_websocket")
