"""Services that a client calls, and those that it offers."""

import asyncio
import json
import math
from typing import Any

import pytest

from server.access.identity import GUEST
from server.rosbridge.capabilities.service_offers import MAX_CALLS
from server.rosbridge.effects import (
    Answer,
    CallService,
    CloseService,
    OpenService,
    Response,
    Send,
)
from server.rosbridge.offered_services import OfferedServices
from server.rosbridge.outgoing import replied
from tests.unit.rosbridge.clients import Server, error, say, without_log


def test_a_service_call_is_answered_with_its_id(server: Server) -> None:
    client = server.client()
    (call,) = say(client, op="call_service", service="add", id="c1", args=[1, 2], timeout=2.5)
    assert isinstance(call, CallService)
    assert (call.service, call.args, call.timeout) == ("/add", [1, 2], 2.5)
    messages = replied(call.reply, Response(server.types.message("std_msgs/Int8"), b"\x03"))
    assert call.done(messages, "", 0.0) == [
        Send('{"op":"service_response","service":"add","id":"c1","values":{"data":3},"result":true}')
    ]


def test_a_failed_service_call_is_told_twice(server: Server) -> None:
    (call,) = say(server.client(), op="call_service", service="/add")
    assert isinstance(call, CallService)
    assert (call.args, call.timeout) == ({}, math.inf)
    assert without_log(call.done((), "no such service", 0.0)) == [
        Send('{"op":"status","level":"error","msg":"call_service /add: no such service"}'),
        Send('{"op":"service_response","service":"/add","values":"no such service","result":false}'),
    ]


@pytest.mark.parametrize(
    "fields", [{"service": "a b"}, {"args": "x"}, {"args": 5}, {"timeout": "1"}, {"compression": 5}], ids=str
)
def test_a_bad_service_call_is_answered_too(server: Server, fields: dict[str, Any]) -> None:
    status, response = say(server.client(), **{"op": "call_service", "service": "/add", "id": 1, **fields})
    assert isinstance(status, Send)
    assert isinstance(response, Send)
    assert json.loads(status.data)["level"] == "error"
    assert json.loads(response.data)["result"] is False
    assert json.loads(response.data)["id"] == 1


def test_service_calls_under_way_are_counted(server: Server) -> None:
    client = server.client()
    calls = [say(client, op="call_service", service="/a")[0] for _ in range(100)]
    assert len(say(client, op="call_service", service="/a")) == 2
    assert isinstance(calls[0], CallService)
    calls[0].done((), "late", 0.0)
    (call,) = say(client, op="call_service", service="/a")
    assert isinstance(call, CallService)


def test_ros_calls_a_service_that_a_client_offers(server: Server) -> None:
    client = server.client()
    assert server.client(GUEST) != client
    offer = {"op": "advertise_service", "service": "add", "type": "laser_bot_battle/AddNewRobot"}
    (opened,) = say(client, **offer)
    assert isinstance(opened, OpenService)
    assert opened.service == "/add"
    error(say(server.client(GUEST), **{**offer, "service": "/mine"}))
    (sent,) = client.asked(5, "/add", b"", 0.0)
    assert isinstance(sent, Send)
    call = json.loads(sent.data)
    assert (call["op"], call["service"], call["args"]) == ("call_service", "add", {})
    answer = {"op": "service_response", "service": "add", "id": call["id"]}
    assert say(client, **answer, values={"ID": 7}, result=True) == [Answer(5, b"\x07", "")]
    error(say(client, **answer, values={"ID": 7}, result=True))
    for result in (False, None):  # a handler of roslibpy that returns no success, though it has filled in a response
        (sent,) = client.asked(5, "/add", b"", 0.0)
        assert isinstance(sent, Send)
        answer["id"] = json.loads(sent.data)["id"]
        assert say(client, **answer, values={"ID": 7}, result=result) == [Answer(5, b"\x07", "")]
    failures: list[tuple[dict[str, Any], str]] = [
        ({"result": False, "values": "no"}, "no"),
        ({"result": False, "values": {}}, "{}"),
        ({"result": False}, "{}"),
        ({"result": False, "values": {"a": float("nan")}}, '{"a": NaN}'),
        ({"values": {"ID": 1000}}, "ID: int8"),
    ]
    for fields, reason in failures:
        (sent,) = client.asked(6, "/add", b"", 0.0)
        assert isinstance(sent, Send)
        failed, *_ = say(client, **answer | {"id": json.loads(sent.data)["id"], **fields})
        assert isinstance(failed, Answer)
        assert failed.data is None
        assert failed.reason.startswith(reason)
    assert client.closed() == [CloseService("/add")]
    assert client.asked(7, "/add", b"", 0.0) == [Answer(7, None, "the service is gone")]


OFFER = {"op": "advertise_service", "service": "add", "type": "laser_bot_battle/AddNewRobot"}


def test_the_last_client_that_offers_a_service_has_it(server: Server) -> None:
    """A page that was loaded again, whose old connection nobody has found dead yet."""
    old, new = server.client(), server.client()
    say(old, **OFFER)
    (asked,) = old.asked(5, "/add", b"", 0.0)
    assert isinstance(asked, Send)
    say(new, op="set_level", level="warning")
    closed, warned, opened = say(new, **OFFER)
    assert closed == CloseService("/add")
    assert isinstance(warned, Send)
    assert "another client of rosbridge offered /add before" in json.loads(warned.data)["msg"]
    assert isinstance(opened, OpenService)
    late = {"op": "service_response", "id": json.loads(asked.data)["id"], "values": {"ID": 7}, "result": True}
    error(say(old, **late))
    assert [type(effect) for effect in new.asked(6, "/add", b"", 0.0)] == [Send]
    assert say(old, op="unadvertise_service", service="/add") == []
    assert old.closed() == []
    assert new.closed() == [CloseService("/add")]
    (again,) = say(server.client(), **OFFER)
    assert isinstance(again, OpenService)


def test_calls_that_are_never_answered_do_not_keep_others_from_the_client(server: Server) -> None:
    client = server.client()
    say(client, **OFFER)
    for call in range(MAX_CALLS):
        assert len(client.asked(call, "/add", b"", 0.0)) == 1
    gives_way, sent = client.asked(MAX_CALLS, "/add", b"", 0.0)
    assert gives_way == Answer(0, None, "too many calls wait for this client")
    assert isinstance(sent, Send)


def test_a_caller_that_has_gone_is_forgotten(server: Server) -> None:
    client, sent = server.client(), list[Send]()
    say(client, **OFFER)
    offered = OfferedServices(lambda _, effects: sent.extend(each for each in effects if isinstance(each, Send)))

    async def scenario() -> None:
        caller = asyncio.create_task(offered.ask(client, "/add", b""))
        await asyncio.sleep(0)
        caller.cancel()
        await asyncio.wait([caller])

    asyncio.run(scenario())
    call = json.loads(sent[0].data)
    late = say(client, op="service_response", service="add", id=call["id"], values={"ID": 7}, result=True)
    assert "no call has the id" in error(late)["msg"]
