"""Topics and services over the WebSocket, for operators, who may use all of them."""

import json
import time
import xmlrpc.client
from collections.abc import Callable
from typing import Any

import pytest

from tests.integration.rosbridge.ends import Client, RosSide, join
from tests.integration.tcpros.ends import RospyPeer
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

Connect = Callable[..., Client]


def test_a_second_client_gets_the_latched_state_at_once(ros: RosSide, client: Connect) -> None:
    ros.status(1)
    first, second = client(), client()
    first.watch()
    first.hear_status(1)
    second.watch()
    assert second.hear()["msg"]["game"] == 1
    assert first.hears_nothing()


def test_each_subscription_of_a_client_gets_the_latched_message(client: Connect) -> None:
    maps, page = client().operate(), client().operate()
    maps.say("advertise", topic="/map", type="std_msgs/String", latch=True)
    maps.say("publish", topic="/map", msg={"data": "the hall"})
    for subscription in ("subscribe:/map:1", "subscribe:/map:2"):
        page.say("subscribe", topic="/map", type="std_msgs/String", id=subscription)
        assert page.hear()["msg"] == {"data": "the hall"}


def test_who_comes_later_gets_the_last_message_of_each_page_that_latches(ros: RosSide, client: Connect) -> None:
    one, other = client().operate(), client().operate()
    for page, texts in ((one, "ab"), (other, "xy")):
        page.say("advertise", topic="/latched_by_two", type="std_msgs/String", latch=True)
        for text in texts:
            page.say("publish", topic="/latched_by_two", msg={"data": text})
        page.say("call_service", service="/rosapi/get_time")
        page.hear()
    ros.listen("/latched_by_two", "std_msgs/String")
    until(lambda: {"data": "y"} in ros.heard("/latched_by_two"))
    assert [message["data"] for message in ros.heard("/latched_by_two")] in (["b", "y"], ["a", "b", "x", "y"])
    for _ in range(2):  # the first one opens the topic, the second one finds it open
        later = client().operate()
        later.say("subscribe", topic="/latched_by_two")
        heard = [later.hear()["msg"]["data"]]
        while heard[-1] != "y":
            heard.append(later.hear()["msg"]["data"])
        assert "b" in heard
    one.close()

    def is_left_with_one() -> bool:
        last = client().operate()
        last.say("subscribe", topic="/latched_by_two")
        found = [last.hear()["msg"]["data"]]
        while not last.hears_nothing_for_now():
            found.append("more")
        return found == ["y"]

    until(is_left_with_one)


def test_a_page_that_is_loaded_again_latches_one_message(client: Connect) -> None:
    for text in "abc":
        page = client().operate()
        page.say("advertise", topic="/loaded_again", type="std_msgs/String", latch=True)
        page.say("publish", topic="/loaded_again", msg={"data": text})
        page.say("call_service", service="/rosapi/get_time")
        page.hear()
        if text != "c":
            page.close()
    opener, later = client().operate(), client().operate()
    opener.say("subscribe", topic="/loaded_again")
    while opener.hear()["msg"]["data"] != "c":
        pass
    later.say("subscribe", topic="/loaded_again")
    assert later.hear()["msg"]["data"] == "c"
    assert later.hears_nothing_for_now()


def test_a_latched_message_ends_with_its_publisher(ros_master: RosMaster, client: Connect) -> None:
    first = client().operate()
    first.say("subscribe", topic="/goal", type="std_msgs/String")
    for name in ("planner0", "planner1"):
        planner = RospyPeer(name, ros_master.env)
        try:
            planner.advertise("/goal", True)
            planner.do("publish", "/goal", name)
            assert first.hear()["msg"] == {"data": name}
            if name == "planner1":
                second = client().operate()
                second.say("subscribe", topic="/goal")
                assert second.hear()["msg"] == {"data": name}
                assert second.hears_nothing()
        finally:
            planner.close()


def test_what_one_publishes_all_subscribers_get_until_they_unsubscribe(client: Connect) -> None:
    speaker, first, second = client().operate(), client().operate(), client().operate()
    for listener in (first, second):
        listener.say("subscribe", topic="chat", type="std_msgs/String", id="s")
    speaker.say("advertise", topic="/chat", type="std_msgs/String")

    newest = join(lambda data: speaker.say("publish", topic="/chat", msg={"data": data}), first)
    # each by the name that it used itself
    while (heard := second.hear()) != {"op": "publish", "topic": "chat", "msg": {"data": newest}}:
        assert heard["topic"] == "chat"
    second.say("unsubscribe", topic="chat", id="s")
    second.say("call_service", service="/add_new_robot", id="after that")
    assert second.hear()["id"] == "after that"
    speaker.say("publish", topic="/chat", msg={"data": "again"})
    assert first.hear()["msg"] == {"data": "again"}
    assert second.hears_nothing()


def test_the_last_words_of_a_client_that_is_gone_keep_nothing_from_others(
    ros_master: RosMaster, client: Connect
) -> None:
    """They wait for the topic's type, which is asked for in ROS, while the client goes."""
    planner = RospyPeer("planner2", ros_master.env)
    try:
        planner.advertise("/route", True)
        planner.do("publish", "/route", "there")
        hasty, heir = client().operate(), client().operate()
        hasty.say("advertise_service", service="/plan", type="std_srvs/Empty")
        for number in range(2):
            hasty.say("subscribe", topic="/route", id=f"subscribe:/route:{number}")
        hasty.close()

        def inherits() -> bool:
            heir.say("advertise_service", service="/plan", type="std_srvs/Empty", id="plan")
            return heir.hears_nothing_for_now()

        until(inherits, 10, "another client offers the service")
        heir.say("subscribe", topic="/route")
        assert heir.hear()["msg"] == {"data": "there"}
    finally:
        planner.close()


def test_a_client_that_subscribes_and_asks_hears_the_answer(ros_master: RosMaster, client: Connect) -> None:
    """As action clients do, by goal and feedback; rosbridge has gone on publishing the question since the last one."""
    echo = Program.python("tests.integration.rosbridge.echo_node", env=ros_master.env)
    try:
        echo.wait_for("ready")
        for number in range(5):
            asking = client().operate()
            asking.say("subscribe", topic="/answer", type="std_msgs/String")
            asking.say("publish", topic="/question", type="std_msgs/String", msg={"data": str(number)})
            assert asking.hear()["msg"] == {"data": str(number)}
            asking.close()
    finally:
        echo.stop()


@pytest.mark.parametrize("topic", ["/café/menu", "/a@b", "/x(1)/y", "/n#1"])
def test_what_the_ros_master_lists_can_be_published_and_heard(ros: RosSide, client: Connect, topic: str) -> None:
    page = client().operate()
    ros.listen(topic, "std_msgs/String")
    page.say("advertise", topic=topic, type="/std_msgs/String")

    def heard() -> bool:
        page.say("publish", topic=topic, msg={"data": "there"})
        return bool(ros.heard(topic))

    until(heard)
    page.say("subscribe", topic=topic)

    def comes_back() -> bool:
        ros.publish(topic, "std_msgs/String", data="back")
        return not page.hears_nothing_for_now()

    until(comes_back)
    page.say("call_service", service="/rosapi/topics", id="topics")
    answer = page.hear()
    while answer["op"] == "publish":
        answer = page.hear()
    assert topic in answer["values"]["topics"]


def test_a_publisher_that_cannot_be_reached_is_told_to_who_waits_for_it(ros_master: RosMaster, client: Connect) -> None:
    with xmlrpc.client.ServerProxy(ros_master.uri) as master:
        lost = f"http://127.0.0.1:{free_port()}/"
        master.registerPublisher("/lost_robot", "/lost", "std_msgs/String", lost)
        try:
            for _ in range(2):  # the second one comes when it is known already
                page = client().operate()
                page.say("subscribe", topic="/lost")
                told = page.hear_error()
                assert told.startswith(f"no messages of /lost come from {lost}"), told
        finally:
            master.unregisterPublisher("/lost_robot", "/lost", lost)


def test_requests_come_in_binary_messages_several_in_one_and_one_in_several(client: Connect) -> None:
    page = client().operate()
    asked = [json.dumps({"op": "call_service", "service": "/rosapi/get_time", "id": f"é{n}"}) for n in range(60)]
    page.socket.send("\ufeff" + "\n".join(asked[:30]) + "\0")
    binary = " ".join(asked[30:]).encode()
    for start in range(0, len(binary), 7):
        page.socket.send(binary[start : start + 7])
    assert {page.hear()["id"] for _ in asked} == {f"é{n}" for n in range(60)}


def test_a_publisher_serves_until_its_last_client_has_gone(ros: RosSide, client: Connect) -> None:
    ros.listen("/shared", "std_msgs/String")
    first, second = client().operate(), client().operate()
    for speaker in (first, second):
        speaker.say("advertise", topic="/shared", type="std_msgs/String")

    def connected() -> bool:
        first.say("publish", topic="/shared", msg={"data": "first"})
        return bool(ros.heard("/shared"))

    until(connected)
    first.close()
    second.say("publish", topic="/shared", msg={"data": "second"})
    until(lambda: ros.heard("/shared")[-1] == {"data": "second"})
    second.close()
    third = client().operate()
    third.say("advertise", topic="/shared", type="std_msgs/String")
    third.say("publish", topic="/shared", msg={"data": "third"})
    until(lambda: ros.heard("/shared")[-1] == {"data": "third"})


def test_a_topic_has_one_type(client: Connect) -> None:
    first, second = client().operate(), client().operate()
    first.say("advertise", topic="/typed", type="std_msgs/String", latch=True)
    first.say("publish", topic="/typed", msg={"data": "x"})
    first.say("subscribe", topic="/typed")
    assert first.hear()["msg"] == {"data": "x"}
    second.say("advertise", topic="/typed", type="std_msgs/Bool", id=3)
    assert second.hear() == {
        "op": "status", "level": "error", "msg": "/typed is of type std_msgs/String, not std_msgs/Bool", "id": 3,
    }  # fmt: skip


def test_throttled_messages_come_no_faster_and_queued_ones_are_not_lost(ros: RosSide, client: Connect) -> None:
    throttled, queued = client().operate(), client().operate()
    throttled.say("subscribe", topic="/fast", type="std_msgs/Int32", throttle_rate=300)
    queued.say("subscribe", topic="/fast", type="std_msgs/Int32", throttle_rate=100, queue_length=10)

    newest = join(lambda data: ros.publish("/fast", "std_msgs/Int32", data=data), queued, lambda number: -number)
    while throttled.hear()["msg"]["data"] != newest:
        pass
    assert throttled.hears_nothing(), "the next one need not wait"
    start = time.monotonic()
    for number in range(1, 6):
        ros.publish("/fast", "std_msgs/Int32", data=number)
    assert [queued.hear()["msg"]["data"] for _ in range(5)] == [1, 2, 3, 4, 5]
    assert time.monotonic() - start > 0.35
    assert throttled.hear()["msg"]["data"] == 1
    assert throttled.hears_nothing()


def test_a_service_answers(ros: RosSide, client: Connect) -> None:
    operator = client().operate()
    forms: list[dict[str, Any]] = [{}, {"args": []}, {"args": {}}, {"args": None}]
    for args in forms:
        operator.say("call_service", service="add_new_robot", id="call:1", **args)
        assert operator.hear() == {
            "op": "service_response", "service": "add_new_robot", "values": {"ID": 7}, "result": True, "id": "call:1",
        }  # fmt: skip


@pytest.mark.parametrize(
    ("service", "args", "reason"),
    [
        ("/fails", {}, "no robot is left"),
        ("/no_such_service", {}, "there is no such service"),
        ("/add_new_robot", {"ID": 1}, "has no field"),
        ("/add_new_robot", [1], "takes 0 arguments"),
        ("not a name", {}, "is not a ROS name"),
    ],
)
def test_a_failed_service_call_says_why(ros: RosSide, client: Connect, service: str, args: object, reason: str) -> None:
    operator = client().operate()
    operator.say("call_service", service=service, args=args, id=9)
    assert reason in operator.hear_error()
    answer = operator.hear()
    assert reason in answer.pop("values")
    assert answer == {"op": "service_response", "service": service, "result": False, "id": 9}


@pytest.mark.slow
def test_a_slow_service_is_waited_for_no_longer_than_asked_and_blocks_nobody(ros: RosSide, client: Connect) -> None:
    operator = client().operate()
    for number in range(100):
        operator.say("call_service", service="/slow", id=number, timeout=2)
    operator.say("call_service", service="/add_new_robot", id="one too many")
    assert "100 service calls" in operator.hear_error()
    assert operator.hear()["id"] == "one too many"
    other = client().operate()
    other.say("call_service", service="/add_new_robot")
    assert other.hear()["result"] is True
    assert operator.hears_nothing(0)  # its calls are still under way
    answers = [operator.hear() for _ in range(200)]
    assert [a["id"] for a in answers if a["op"] == "service_response"] == list(range(100))
    assert {a["values"] for a in answers if a["op"] == "service_response"} == {"no response within 2 s"}


def test_a_robot_that_hangs_delays_nobody_and_is_driven_again_when_it_is_back(
    ros_master: RosMaster, client: Connect
) -> None:
    operator = client().operate()
    robot = RosSide(ros_master.env)
    try:
        robot.listen("/Robot8/command")

        def driven(speed: int) -> bool:
            operator.drive(8, {"linear_x": speed})
            return any(command["linear_x"] == speed for command in robot.heard("/Robot8/command"))

        until(lambda: driven(1), what="the robot")
        robot.freeze(True)
        for _ in range(20_000):
            operator.drive(8)
        operator.say("nonsense")
        operator.hear_error()
        robot.freeze(False)
        until(lambda: driven(2), what="the robot, back again")
    finally:
        robot.close()
