"""Parameters as JSON text: what the ROS parameter server can hold, which is what XML-RPC can carry."""

import base64
import json
import math
import xmlrpc.client
from typing import Any

from server.rosapi.handlers import sendable
from server.websocket.requests import RequestError, brief

INT32 = range(-(2**31), 2**31)
MAX_DEPTH = 50  # lists and objects inside each other


def parameter(text: str) -> Any:
    """The parameter that the JSON `text` describes. RequestError when it is no JSON, or cannot be a parameter."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        raise RequestError(
            f"a parameter's value must be JSON text, and {brief(text)} is not; a string needs quotes of its own"
        ) from None
    _check(value, MAX_DEPTH)
    return value


def as_json(value: Any) -> str:
    """The JSON text of a parameter: NaN and infinities become null, binary data becomes base64, dates become text."""
    return json.dumps(_plain(value))


def _check(value: Any, depth: int) -> None:
    if depth < 0:
        raise RequestError(f"a parameter may have {MAX_DEPTH} lists and objects inside each other")
    match value:
        case None:
            raise RequestError("null cannot be the value of a parameter; delete the parameter instead")
        case bool():
            pass
        case int():
            if value not in INT32:
                raise RequestError(f"whole numbers in parameters have 32 bits, and {brief(value)} has more")
        case float():
            if not math.isfinite(value):
                raise RequestError("a number in a parameter must be finite")
        case str():
            sendable(value)
        case list():
            for element in value:
                _check(element, depth - 1)
        case dict():
            for key, element in value.items():
                sendable(key)
                _check(element, depth - 1)


def _plain(value: Any) -> Any:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case list():
            return [_plain(element) for element in value]
        case dict():
            return {key: _plain(element) for key, element in value.items()}
        case xmlrpc.client.Binary():
            return base64.b64encode(value.data).decode("ascii")
        case xmlrpc.client.DateTime():
            return str(value)
    return value
