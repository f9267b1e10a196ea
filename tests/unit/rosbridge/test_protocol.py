"""A client's conversation: JSON text in, effects out."""

import json
from typing import Any

import pytest

from server.access.identity import GUEST, OPERATOR, session_identity
from server.messages.types import ConversionError
from server.rosbridge.compression import encode
from server.rosbridge.effects import (
    CallService,
    ClosePublisher,
    CloseSubscription,
    FindType,
    GoOn,
    Later,
    Log,
    OpenPublisher,
    OpenService,
    OpenSubscription,
    Publish,
    Read,
    Replay,
    Response,
    Send,
    Unlatch,
)
from server.rosbridge.outgoing import replied
from server.rosbridge.protocol import AT_ONCE, Client
from server.websocket.requests import one_line
from tests.unit.rosbridge.clients import ADVERTISE, PUBLISH, TOKEN, Server, error, say, without_log


def test_the_words_of_a_page_become_commands_to_its_robot(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    server.battle()
    (opened,) = al.receive(ADVERTISE, 0.0)
    assert isinstance(opened, OpenPublisher)
    assert (opened.topic, opened.type.name, opened.latch) == ("/Robot3/command", "laser_bot_battle/Robot_msg", False)
    assert al.receive(PUBLISH, 0.0) == [Publish("/Robot3/command", b"\x01\xff\x00")]


@pytest.mark.parametrize(
    "text",
    ["nonsense", "[]", "1", "null", '"x"', '{"op": NaN}', '{"op": "publish", "msg": 1e999}', "{x", b"\xff", b"{}", "{}",
     '{"op": 5}', '{"op": null}', '{"op": "no such thing"}', '{"op": "handlers"}', '{"op": "__init__"}',
     '{"op": "Publish"}'],
)  # fmt: skip
def test_what_is_no_request_gets_an_error_and_changes_nothing(server: Server, text: str | bytes) -> None:
    client = server.client()
    error(client.receive(text, 0.0))
    assert client.closed() == []


@pytest.mark.parametrize("text", ["", " ", "{", "\ufeff", b"", b"\0", b"\xc3"])
def test_what_may_stand_between_requests_or_begin_one_is_no_error(server: Server, text: str | bytes) -> None:
    client = server.client()
    assert client.receive(text, 0.0) == []


def test_what_takes_long_to_look_through_is_not_looked_through_here(server: Server) -> None:
    for text in ("[" * 60000, '{"op": "publish", "topic": ' + "1" * 5000 + "}", b" " * 5000):
        assert server.client().receive(text, 0.0) == [Read(text)]


def test_a_message_of_many_requests_gives_others_their_turn(server: Server) -> None:
    client = server.client()
    effects = client.receive('{"op": "advertise", "topic": 5}' * 40, 0.0)
    sent = [effect for effect in effects if isinstance(effect, Send)]
    assert (len(sent), effects[-1]) == (AT_ONCE, GoOn())
    rest = [*client.go_on(0.0), *client.go_on(0.0)]
    assert len([effect for effect in rest if isinstance(effect, Send)]) == 40 - AT_ONCE
    assert client.go_on(0.0) == []


def test_requests_in_binary_messages_and_in_parts_are_understood(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    server.battle()
    (opened,) = al.receive(ADVERTISE.encode(), 0.0)
    assert isinstance(opened, OpenPublisher)
    assert al.receive(PUBLISH[:20], 0.0) == []
    published = Publish("/Robot3/command", b"\x01\xff\x00")
    assert al.receive(PUBLISH[20:] + PUBLISH, 0.0) == [published, published]


@pytest.mark.parametrize(
    "request_",
    [
        {"op": "advertise"},
        {"op": "advertise", "topic": "/a"},
        {"op": "advertise", "topic": 5, "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/a", "type": ["std_msgs/String"]},
        {"op": "advertise", "topic": "/a", "type": "std_msgs/Nothing"},
        {"op": "advertise", "topic": "", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/a b", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/a\n", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/" + "a" * 1000, "type": "std_msgs/String"},
        {"op": "unadvertise"},
        {"op": "publish", "msg": {}},
        {"op": "publish", "topic": "/a", "msg": {}},
        {"op": "publish", "topic": "/Robot0/command", "msg": {"linear_x": 1.5}},
        {"op": "publish", "topic": "/Robot0/command", "msg": None},
        {"op": "subscribe", "topic": "/a"},
        {"op": "subscribe", "topic": "/a", "type": "nothing/Nothing"},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "throttle_rate": "fast"},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "queue_length": 1.5},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "queue_length": True},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "fragment_size": "x"},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "compression": 1},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "throttle_rate": 10**400},
        {"op": "unsubscribe", "topic": {}},
        {"op": "advertise_service"},
        {"op": "advertise_service", "service": "/a"},
        {"op": "advertise_service", "service": "/a", "type": "std_srvs/Nothing"},
        {"op": "service_response", "service": "/a", "values": {}},
        {"op": "fragment", "data": "x"},
        {"op": "png", "data": "x"},
        {"op": "call_service"},
        {"op": "set_level", "level": "loud"},
        {"op": "set_level"},
        {"op": "status", "level": "info"},
        {"op": "status", "level": 5, "msg": "x"},
        {"op": "auth"},
        {"op": "auth", "client": "operator"},
        {"op": "auth", "client": "operator", "mac": None},
        {"op": "auth", "client": "operator", "mac": ["secret"]},
        {"op": "auth", "client": {"name": "operator"}, "mac": "secret"},
    ],
)
def test_a_bad_request_gets_an_error_with_its_id_and_changes_nothing(server: Server, request_: dict[str, Any]) -> None:
    client = server.client()
    assert error(say(client, **{**request_, "id": "i1"}))["id"] == "i1"
    assert client.closed() == []
    assert client.identity == OPERATOR


@pytest.mark.parametrize(
    ("given", "echoed"), [("x", "x"), (7, 7), ("", ""), (None, None), ([1], None), (True, None), (1.5, 1.5)]
)
def test_an_id_is_text_or_a_number(server: Server, given: Any, echoed: Any) -> None:
    assert error(say(server.client(), op="nonsense", id=given)).get("id") == echoed


@pytest.mark.parametrize(("latch", "latches"), [(1, True), ("yes", True), (0, False), (None, False), ("", False)])
def test_latch_may_be_anything_that_is_true_or_not(server: Server, latch: Any, latches: bool) -> None:
    (opened,) = say(server.client(), op="advertise", topic="/a", type="std_msgs/String", latch=latch)
    assert isinstance(opened, OpenPublisher)
    assert opened.latch is latches


@pytest.mark.parametrize("name", ["std_msgs/String", "/std_msgs//String", "std_msgs/msg/String"])
def test_a_type_may_be_written_in_several_ways(server: Server, name: str) -> None:
    client = server.client()
    (opened,) = say(client, op="advertise", topic="/a", type=name)
    assert isinstance(opened, OpenPublisher)
    assert opened.type.name == "std_msgs/String"
    service = name.replace("std_msgs", "std_srvs").replace("msg", "srv").replace("String", "Empty")
    (offered,) = say(client, op="advertise_service", service="/b", type=service)
    assert isinstance(offered, OpenService)
    assert offered.type.name == "std_srvs/Empty"


@pytest.mark.parametrize(
    "wish",
    [
        {"compression": "zip"},
        {"compression": ""},
        {"compression": "NONE"},
        {"throttle_rate": -1},
        {"throttle_rate": 0.0},
    ],
)
def test_what_cannot_be_had_is_no_reason_to_get_nothing(server: Server, wish: dict[str, Any]) -> None:
    client = server.client()
    subscribe = {"op": "subscribe", "topic": "/a", "type": "std_msgs/String"}
    assert [type(effect) for effect in say(client, **subscribe, **wish)] == [OpenSubscription]
    (subscription,) = server.graph.subscriptions("/a")
    assert subscription.form.compression == "none"
    message: Any = object()
    assert [subscription.offer(message, 0.0) for _ in range(2)] == [message, message], "none has to wait"
    (call,) = say(client, op="call_service", service="/b", **wish)
    assert isinstance(call, CallService)
    assert call.reply.compression == "none"


def test_a_throttle_rate_beyond_all_measure_is_the_longest(server: Server) -> None:
    assert len(say(server.client(), op="subscribe", topic="/a", type="std_msgs/String", throttle_rate=1e300)) == 1


def test_everybody_may_watch_the_battle_and_nothing_else(server: Server) -> None:
    guest = server.client(GUEST)
    (opened,) = say(guest, op="subscribe", topic="game_status", type="laser_bot_battle/GameStatus")
    assert isinstance(opened, OpenSubscription)
    assert opened.topic == "/game_status"
    (replay,) = say(server.client(GUEST), op="subscribe", topic="/game_status")
    assert replay == Replay("/game_status")
    requests: list[dict[str, Any]] = [
        {"op": "subscribe", "topic": "/rosout", "type": "rosgraph_msgs/Log"},
        {"op": "subscribe", "topic": "/game_status", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/game_status", "type": "laser_bot_battle/GameStatus"},
        {"op": "publish", "topic": "/game_status", "msg": {}},
        {"op": "publish", "topic": "game_status", "msg": {}},
        {"op": "advertise", "topic": "/Robot3/command", "type": "laser_bot_battle/Robot_msg"},
    ]
    for second, request in enumerate(requests):
        error(say(guest, float(second), **request))


def test_topics_open_with_the_first_client_and_close_with_the_last(server: Server) -> None:
    first, second = server.client(), server.client()
    topic = {"topic": "/a", "type": "std_msgs/String"}
    (opened,) = say(first, op="advertise", **topic, latch=True)
    assert isinstance(opened, OpenPublisher)
    assert opened.latch
    assert say(second, op="advertise", **topic) == []
    assert say(first, op="advertise", **topic) == []
    assert say(first, op="unadvertise", topic="a") == [Unlatch("/a")]
    assert second.closed() == [ClosePublisher("/a")]
    (subscribed,) = say(first, op="subscribe", **topic)
    assert isinstance(subscribed, OpenSubscription)
    assert say(second, op="subscribe", topic="/a") == [Replay("/a")]
    assert first.closed() == []
    assert say(second, op="unsubscribe", topic="/a") == [CloseSubscription("/a")]


def test_a_topic_has_one_type_while_it_is_open(server: Server) -> None:
    first, second = server.client(), server.client()
    say(first, op="subscribe", topic="/a", type="std_msgs/String")
    assert error(say(second, op="advertise", topic="/a", type="std_msgs/Bool"))["msg"] == (
        "/a is of type std_msgs/String, not std_msgs/Bool"
    )
    first.closed()
    (opened,) = say(second, op="advertise", topic="/a", type="std_msgs/Bool")
    assert isinstance(opened, OpenPublisher)


def test_subscriptions_by_id_end_one_by_one(server: Server) -> None:
    client = server.client()
    for number in (1, 2):
        say(client, op="subscribe", topic="/a", type="std_msgs/String", id=number)
    assert say(client, op="unsubscribe", topic="/a", id=1) == []
    assert say(client, op="unsubscribe", topic="/a", id=1) == []
    assert say(client, op="unsubscribe", topic="/a", id=2) == [CloseSubscription("/a")]
    for number in (1, 2):
        say(client, op="subscribe", topic="/a", type="std_msgs/String", id=number)
    assert say(client, op="unsubscribe", topic="/a") == [CloseSubscription("/a")]


def test_a_warning_is_sent_to_those_who_want_warnings(server: Server) -> None:
    client = server.client()
    assert say(client, op="unadvertise", topic="/a") == []
    say(client, op="set_level", level="warning")
    (sent,) = say(client, op="unadvertise", topic="/a", id=1)
    assert isinstance(sent, Send)
    assert json.loads(sent.data) == {
        "op": "status", "level": "warning", "msg": "/a is not advertised by this client", "id": 1,
    }  # fmt: skip
    say(client, op="set_level", level="none")
    assert say(client, op="nonsense") == []


def test_a_client_cannot_open_topics_without_end(server: Server) -> None:
    client = server.client()
    for number in range(1000):
        say(client, op="subscribe", topic=f"/s{number}", type="std_msgs/String")
        say(client, op="advertise", topic=f"/p{number}", type="std_msgs/String")
    assert "1000 topics" in error(say(client, op="subscribe", topic="/more", type="std_msgs/String"))["msg"]
    assert "1000 topics" in error(say(client, op="advertise", topic="/more", type="std_msgs/String"))["msg"]
    for number in range(99):
        say(client, op="subscribe", topic="/s0", id=number)
    assert "100 times" in error(say(client, op="subscribe", topic="/s0", id="more"))["msg"]


def test_a_response_that_is_not_of_its_type_is_none(server: Server) -> None:
    (call,) = say(server.client(), op="call_service", service="/add")
    assert isinstance(call, CallService)
    with pytest.raises(ConversionError):
        replied(call.reply, Response(server.types.message("std_msgs/Int8"), b"too long"))


def test_a_refusal_to_drive_is_told_once_a_second_or_when_its_reason_changes(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    server.battle(game=0)
    assert "no battle is running" in error(al.receive(PUBLISH, 0.0))["msg"]
    assert al.receive(PUBLISH, 0.5) == []
    error(al.receive(PUBLISH, 1.1))
    server.battle(now=1.1, robot=4)
    assert "/Robot4/command only" in error(al.receive(PUBLISH, 1.2))["msg"]


def test_a_leaving_driver_leaves_a_neutral_command(server: Server) -> None:
    server.battle()
    al = server.client(session_identity(TOKEN))
    al.receive(PUBLISH, 0.0)
    assert al.closed() == [Publish("/Robot3/command", bytes(3)), ClosePublisher("/Robot3/command")]


def test_what_is_refused_is_not_told_at_length(server: Server) -> None:
    server.battle()
    guest, al, long = server.client(GUEST), server.client(session_identity(TOKEN)), "x" * 60_000
    refused = [
        guest.receive(json.dumps({"op": "subscribe", "topic": "/game_status", "type": long}), 0.0),
        al.receive(json.dumps({"op": "advertise", "topic": "/Robot3/command", "type": long}), 0.0),
    ]
    assert all(len(error(effects)["msg"]) < 200 for effects in refused)


def test_a_line_for_the_log_is_one_short_line() -> None:
    assert one_line("al may not drive") == "al may not drive"
    assert one_line("a\nWARNING \x1b[31m \ud800") == r"'a\nWARNING \x1b[31m \ud800'"
    assert len(one_line("x" * 60_000)) == 300


def test_nonsense_does_not_fill_the_log(server: Server) -> None:
    client = server.client()
    lines = [e for n in range(100) for e in client.receive('{"x": y}', n / 100) if isinstance(e, Log)]
    assert len(lines) == 6
    assert any(isinstance(e, Log) for e in client.receive('{"x": y}', 1.5))


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("~a", "/rosbridge_websocket/a"),
        ("a//b/", "/a/b"),
        *((name, name) for name in ("/a", "/2-d/x.y", "/café/menu", "/a@b", "/x(1)/y", "/n#1", "/机器人/速度")),
    ],
)
def test_names_are_those_that_ros_has_in_use(server: Server, given: str, meant: str) -> None:
    (opened,) = say(server.client(), op="advertise", topic=given, type="std_msgs/String")
    assert isinstance(opened, OpenPublisher)
    assert opened.topic == meant


@pytest.mark.parametrize("name", ["/std_msgs/String", "std_msgs//String", "//std_msgs/String/"])
def test_further_slashes_of_a_type_are_overlooked(server: Server, name: str) -> None:
    client = server.client()
    (opened,) = say(client, op="advertise", topic="/a", type=name)
    assert isinstance(opened, OpenPublisher)
    assert opened.type.name == "std_msgs/String"
    assert error(say(client, op="subscribe", topic="/a", type="/std_msgs/Int8"))
    (replay,) = say(client, op="subscribe", topic="/a", type=name)
    assert isinstance(replay, Replay | OpenSubscription)


def test_a_long_id_is_refused(server: Server) -> None:
    assert "256" in error(say(server.client(), op="subscribe", topic="/a", type="std_msgs/String", id="x" * 257))["msg"]


def test_an_id_that_not_every_answer_could_hold_is_refused(server: Server) -> None:
    refused = error(say(server.client(), op="call_service", service="/a", id="a\ud83d", compression="cbor"))
    assert refused["msg"] == "the id has half a surrogate pair"


def test_what_ros_calls_a_topic_holds(server: Server) -> None:
    client = server.client()
    request = {"op": "advertise", "topic": "/listener"}
    refused = error(say(client, found="std_msgs/String", **request, type="std_msgs/Int32"))
    assert refused["msg"] == "/listener is of type std_msgs/String, not std_msgs/Int32"
    (opened,) = say(client, found="std_msgs/String", op="subscribe", topic="/listener")
    assert isinstance(opened, OpenSubscription)
    assert opened.type.name == "std_msgs/String"
    client.settled("/listener", 0.0)
    assert [type(effect) for effect in say(client, op="publish", topic="/listener", msg={"data": "x"})] == [
        OpenPublisher, Publish,
    ]  # fmt: skip


def test_requests_wait_in_order_until_ros_has_told_the_type_and_after_the_client_is_gone(server: Server) -> None:
    """A page that publishes once and closes: nothing is lost."""
    client = server.client()
    (asked,) = client.receive('{"op":"advertise","topic":"/once","type":"std_msgs/Int8"}', 0.0)
    assert isinstance(asked, FindType)
    for number in (1, 2):
        assert say(client, op="publish", topic="once", msg={"data": number}) == []
    assert client.closed() == []
    opened, *rest = asked.done(None, 0.1)
    assert isinstance(opened, OpenPublisher)
    assert rest == [Publish("/once", b"\x01"), Publish("/once", b"\x02"), ClosePublisher("/once")]


def test_a_driver_who_is_gone_stops_at_once_whatever_waits(server: Server) -> None:
    operator = server.client()
    operator.receive(PUBLISH, 0.0)
    operator.receive('{"op":"subscribe","topic":"/slow"}', 0.0)
    assert operator.closed() == [Publish("/Robot3/command", bytes(3))]


ADVERTISE_GOAL = {"op": "advertise", "topic": "/goal", "type": "std_msgs/Int8"}
GOAL = {"op": "publish", "topic": "/goal"}


def hold(client: Client) -> Later:
    """The client publishes its first goal, which waits."""
    (later,) = say(client, **GOAL, msg={"data": 1})
    assert isinstance(later, Later)
    return later


def test_a_goal_waits_until_its_feedback_would_be_heard_and_no_command_does(server: Server) -> None:
    """ROS has been asked for the type of one topic, and connects the other."""
    client = server.client()
    say(client, **ADVERTISE_GOAL)
    say(client, op="subscribe", topic="/feedback", type="std_msgs/Int8")
    (asked,) = client.receive('{"op":"subscribe","topic":"/status","type":"std_msgs/Int8"}', 0.0)
    assert isinstance(asked, FindType)
    hold(client)
    say(client, op="subscribe", topic="/later", type="std_msgs/Int8")
    assert say(client, **GOAL, msg={"data": 2}) == []
    assert Publish("/Robot3/command", b"\x01\xff\x00") in client.receive(PUBLISH, 0.0)
    assert [type(effect) for effect in asked.done(None, 0.1)] == [OpenSubscription]
    assert client.settled("/status", 0.2) == []
    assert client.settled("/feedback", 0.2) == []
    assert client.settled("/later", 0.4) == [Publish("/goal", b"\x01"), Publish("/goal", b"\x02")]


def test_a_goal_waits_no_longer_than_a_second_and_one_on_a_topic_in_use_not_at_all(server: Server) -> None:
    client = server.client()
    say(client, **ADVERTISE_GOAL)
    client.receive('{"op":"subscribe","topic":"/feedback"}', 0.0)
    later = hold(client)
    assert later.due(1.0) == [Publish("/goal", b"\x01")]
    assert say(client, **GOAL, msg={"data": 2}) == [Publish("/goal", b"\x02")]
    assert later.due(1.0) == []
    say(client, op="unadvertise", topic="/goal")
    say(client, **ADVERTISE_GOAL)
    hold(client)


def test_a_goal_does_not_wait_for_a_subscription_that_is_refused(server: Server) -> None:
    client = server.client()
    say(client, **ADVERTISE_GOAL)
    (asked,) = client.receive('{"op":"subscribe","topic":"/feedback","type":"std_msgs/Int8"}', 0.0)
    assert isinstance(asked, FindType)
    hold(client)
    refused, published = without_log(asked.done("std_msgs/String", 0.1))
    assert error([refused])["msg"] == "/feedback is of type std_msgs/String, not std_msgs/Int8"
    assert published == Publish("/goal", b"\x01")


def test_a_goal_that_waits_is_sent_though_the_client_has_gone(server: Server) -> None:
    client = server.client()
    say(client, **ADVERTISE_GOAL)
    say(client, op="subscribe", topic="/feedback", type="std_msgs/Int8")
    hold(client)
    assert client.closed() == []
    assert client.settled("/feedback", 0.1) == [
        Publish("/goal", b"\x01"), ClosePublisher("/goal"), CloseSubscription("/feedback"),
    ]  # fmt: skip


def test_a_request_in_fragments_and_one_within_a_picture(server: Server) -> None:
    client = server.client()
    text = json.dumps({"op": "publish", "topic": "/Robot3/command", "msg": {"linear_x": 1}})
    for number in (1, 0):
        data = text[: len(text) // 2] if number == 0 else text[len(text) // 2 :]
        effects = say(client, op="fragment", id="f", data=data, num=number, total=2)
    assert [type(effect) for effect in effects] == [OpenPublisher, Publish]
    picture = encode({"op": "publish", "topic": "/Robot3/command", "msg": {}}, "png")
    assert client.receive(picture, 0.0) == [Publish("/Robot3/command", bytes(3))]
    nested = encode(picture, "png")  # type: ignore[arg-type]
    assert "within" in error(client.receive(nested, 0.0))["msg"]


def test_only_operators_send_pictures_whatever_is_around_them(server: Server) -> None:
    picture = encode({"op": "subscribe", "topic": "/game_status"}, "png")
    for who in (GUEST, session_identity(TOKEN)):
        assert error(server.client(who).receive(picture, 0.0))["msg"] == "only operators may send pictures"
    in_parts = say(server.client(GUEST), op="fragment", id="f", data=picture, num=0, total=1)
    assert error(in_parts)["msg"] == "only operators may send pictures"
