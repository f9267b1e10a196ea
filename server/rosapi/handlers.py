"""What all of rosapi's services are made of."""

import re
from collections.abc import Callable, Coroutine
from typing import Any

import rosgraph.names

from server.websocket.requests import RequestError, brief

NODE = "/rosapi"

Values = dict[str, Any]  # of a request or response, by field
# May raise RequestError, MasterError, or OSError when the master does not answer: the caller is told.
Handler = Callable[[Values], Coroutine[Any, Any, Values | bytes]]  # bytes: the response as ROS gets it

NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def sendable(text: str) -> str:
    """`text`; RequestError when XML, and so the ROS master, cannot read it."""
    if NOT_IN_XML.search(text):
        raise RequestError(f"the ROS master takes no control characters: {brief(text)}")
    return text


def global_name(name: str) -> str:
    """The global form of a name as rosapi's clients may write it: `x` is /x, `~x` is /rosapi/x."""
    return str(rosgraph.names.resolve_name(sendable(name), NODE))
