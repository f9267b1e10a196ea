"""From a serialized request to a serialized response."""

import asyncio

import pytest

from laser_bot_battle.master import MasterError
from server.messages.types import Types
from server.rosapi.handlers import Values
from server.rosapi.node import serialized
from server.websocket.requests import RequestError
from tcpros.clock import Clock
from tcpros.specs import ServiceFailure

TOPIC_TYPE = Types().service("rosapi/TopicType")
REQUEST = TOPIC_TYPE.request.pack({"topic": "/chat"}, Clock().now)


async def chat(request: Values) -> Values:
    return {"type": f"{request['topic']} is of type std_msgs/String"}


def test_a_handler_sees_and_gives_values() -> None:
    response = asyncio.run(serialized(TOPIC_TYPE, chat, Clock())(REQUEST))
    assert TOPIC_TYPE.response.values(response) == {"type": "/chat is of type std_msgs/String"}


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (RequestError("no such type"), "no such type"),
        (MasterError("not set"), "not set"),
        (ConnectionRefusedError("refused"), "the ROS master does not answer: refused"),
        (TimeoutError("not within 5 s"), "the ROS master does not answer: not within 5 s"),
    ],
)
def test_the_caller_hears_what_went_wrong(error: Exception, text: str) -> None:
    async def fails(_: Values) -> Values:
        raise error

    with pytest.raises(ServiceFailure, match=f"^{text}$"):
        asyncio.run(serialized(TOPIC_TYPE, fails, Clock())(REQUEST))


@pytest.mark.parametrize("request_bytes", [b"", REQUEST[:-1], REQUEST + b"\0"])
def test_a_broken_request_is_the_caller_s_failure(request_bytes: bytes) -> None:
    with pytest.raises(ServiceFailure):
        asyncio.run(serialized(TOPIC_TYPE, chat, Clock())(request_bytes))
