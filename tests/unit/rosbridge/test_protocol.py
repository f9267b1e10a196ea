"""A client's conversation: JSON text in, effects out."""

import json
from typing import Any

import pytest

from laser_bot_battle.msg import Robot_msg
from server.rosbridge.effects import (
    CallService,
    ClosePublisher,
    CloseSubscription,
    Log,
    OpenPublisher,
    OpenSubscription,
    Publish,
    Replay,
    Send,
)
from server.rosbridge.gate import GUEST, OPERATOR, session_identity
from tests.unit.rosbridge.clients import ADVERTISE, PUBLISH, TOKEN, Server, error, say, without_log


def test_the_words_of_a_page_become_commands_to_its_robot(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    server.battle()
    (opened,) = al.receive(ADVERTISE, 0.0)
    assert isinstance(opened, OpenPublisher)
    assert (opened.topic, opened.type.name, opened.latch) == ("/Robot3/command", "laser_bot_battle/Robot_msg", False)
    assert al.receive(PUBLISH, 0.0) == [Publish("/Robot3/command", Robot_msg(1, -1, False))]


@pytest.mark.parametrize(
    "text",
    ["", " ", "{", "nonsense", "[]", "1", "null", '"x"', '{"op": NaN}', '{"op": "publish", "msg": 1e999}', "[" * 70000,
     '{"op": "publish", "topic": ' + "1" * 5000 + "}", b"\x00", b"{}", "{}", '{"op": 5}', '{"op": null}',
     '{"op": "no such thing"}', '{"op": "handlers"}', '{"op": "__init__"}', '{"op": "Publish"}'],
)  # fmt: skip
def test_what_is_no_request_gets_an_error_and_changes_nothing(server: Server, text: str | bytes) -> None:
    client = server.client()
    error(client.receive(text, 0.0))
    assert client.closed() == []


@pytest.mark.parametrize(
    "request_",
    [
        {"op": "advertise"},
        {"op": "advertise", "topic": "/a"},
        {"op": "advertise", "topic": 5, "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/a", "type": ["std_msgs/String"]},
        {"op": "advertise", "topic": "/a", "type": "std_msgs/Nothing"},
        {"op": "advertise", "topic": "/a", "type": "std_msgs/String", "latch": 1},
        {"op": "advertise", "topic": "", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/a//b", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "~a", "type": "std_msgs/String"},
        {"op": "advertise", "topic": "/ä", "type": "std_msgs/String"},
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
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "throttle_rate": -1},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "queue_length": 1.5},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "queue_length": True},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "fragment_size": "x"},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "compression": "png"},
        {"op": "subscribe", "topic": "/a", "type": "std_msgs/String", "compression": 1},
        {"op": "unsubscribe", "topic": {}},
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
    assert error(client.receive(json.dumps({**request_, "id": "i1"}), 0.0))["id"] == "i1"
    assert client.closed() == []
    assert client.identity == OPERATOR


@pytest.mark.parametrize(("given", "echoed"), [("x", "x"), (7, 7), ("", ""), (None, None), ([1], None), (True, None)])
def test_an_id_is_text_or_a_whole_number(server: Server, given: Any, echoed: Any) -> None:
    assert error(say(server.client(), op="nonsense", id=given)).get("id") == echoed


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
    assert say(first, op="unadvertise", topic="a") == []
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
    assert json.loads(sent.text) == {
        "op": "status", "level": "warning", "msg": "/a is not advertised by this client", "id": 1,
    }  # fmt: skip
    say(client, op="set_level", level="none")
    assert say(client, op="nonsense") == []


def test_a_client_cannot_open_topics_without_end(server: Server) -> None:
    client = server.client()
    for number in range(100):
        say(client, op="subscribe", topic=f"/s{number}", type="std_msgs/String")
        say(client, op="advertise", topic=f"/p{number}", type="std_msgs/String")
    assert "100 topics" in error(say(client, op="subscribe", topic="/more", type="std_msgs/String"))["msg"]
    assert "100 topics" in error(say(client, op="advertise", topic="/more", type="std_msgs/String"))["msg"]
    for number in range(99):
        say(client, op="subscribe", topic="/s0", id=number)
    assert "100 times" in error(say(client, op="subscribe", topic="/s0", id="more"))["msg"]


def test_a_service_call_is_answered_with_its_id(server: Server) -> None:
    client = server.client()
    (call,) = say(client, op="call_service", service="add", id="c1", args=[1, 2], timeout=2.5)
    assert isinstance(call, CallService)
    assert (call.service, call.args, call.timeout) == ("/add", [1, 2], 2.5)
    assert call.done({"sum": 3}, "", 0.0) == [
        Send('{"op":"service_response","service":"add","values":{"sum":3},"result":true,"id":"c1"}')
    ]


def test_a_failed_service_call_is_told_twice(server: Server) -> None:
    (call,) = say(server.client(), op="call_service", service="/add")
    assert isinstance(call, CallService)
    assert (call.args, call.timeout) == ({}, 10.0)
    assert without_log(call.done(None, "no such service", 0.0)) == [
        Send('{"op":"status","level":"error","msg":"call_service /add: no such service"}'),
        Send('{"op":"service_response","service":"/add","values":"no such service","result":false}'),
    ]


@pytest.mark.parametrize(
    "fields", [{"service": "a b"}, {"args": "x"}, {"args": 5}, {"timeout": "1"}, {"compression": "png"}], ids=str
)
def test_a_bad_service_call_is_answered_too(server: Server, fields: dict[str, Any]) -> None:
    status, response = say(server.client(), **{"op": "call_service", "service": "/add", "id": 1, **fields})
    assert isinstance(status, Send)
    assert isinstance(response, Send)
    assert json.loads(status.text)["level"] == "error"
    assert json.loads(response.text)["result"] is False
    assert json.loads(response.text)["id"] == 1


def test_service_calls_under_way_are_counted(server: Server) -> None:
    client = server.client()
    calls = [say(client, op="call_service", service="/a")[0] for _ in range(16)]
    assert len(say(client, op="call_service", service="/a")) == 2
    assert isinstance(calls[0], CallService)
    calls[0].done(None, "late", 0.0)
    (call,) = say(client, op="call_service", service="/a")
    assert isinstance(call, CallService)


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
    assert al.closed() == [Publish("/Robot3/command", Robot_msg(0, 0, False)), ClosePublisher("/Robot3/command")]


def test_nonsense_does_not_fill_the_log(server: Server) -> None:
    client = server.client()
    lines = [e for n in range(100) for e in client.receive("{", n / 100) if isinstance(e, Log)]
    assert len(lines) == 6
    assert any(isinstance(e, Log) for e in client.receive("{", 1.5))
