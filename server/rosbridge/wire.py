"""JSON text on the WebSocket: strict parsing of requests, compact writing of replies."""

import json
import math
import re
from typing import Any

dumps = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode

ROS_NAME = re.compile(r"/?[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)

# A request's id may be text or a whole number (rosbridge protocol 1).
Id = str | int | None


class RequestError(Exception):
    """A client's request cannot be done; the text tells the client why."""


class Request:
    """One operation of a client: typed access to its fields, RequestError where they are missing or wrong."""

    __slots__ = ("fields", "id")

    def __init__(self, fields: dict[str, Any]) -> None:
        self.fields = fields
        given = fields.get("id")
        self.id: Id = given if type(given) in (str, int) else None

    def text(self, name: str) -> str:
        """A string that must be there."""
        value = self.fields.get(name)
        if type(value) is not str:
            raise RequestError(f"the field {name!r} must be a string, {self._given(name)}")
        return value

    def ros_name(self, name: str) -> str:
        """The global ROS name that must be there: rosbridge lives in the root namespace. Whatever is compared with a
        topic or service (the gate's rules above all) must be compared with this form."""
        value = self.text(name)
        if len(value) > 200 or not ROS_NAME.fullmatch(value):
            raise RequestError(f"{brief(value)} is not a ROS name")
        return value if value.startswith("/") else f"/{value}"

    def optional_text(self, name: str, default: str) -> str:
        return default if self.fields.get(name) is None else self.text(name)

    def count(self, name: str, default: int) -> int:
        """A whole number, 0 or more."""
        value = self.fields.get(name)
        if value is None:
            return default
        if type(value) is not int or value < 0:
            raise RequestError(f"the field {name!r} must be a whole number, 0 or more, {self._given(name)}")
        return value

    def number(self, name: str, default: float) -> float:
        """A number, 0 or more."""
        value = self.fields.get(name)
        if value is None:
            return default
        if type(value) not in (int, float) or not 0 <= value < math.inf:
            raise RequestError(f"the field {name!r} must be a number, 0 or more, {self._given(name)}")
        return value  # type: ignore[no-any-return]

    def flag(self, name: str) -> bool:
        """True or false, false when missing."""
        value = self.fields.get(name)
        if value is None:
            return False
        if type(value) is not bool:
            raise RequestError(f"the field {name!r} must be true or false, {self._given(name)}")
        return value

    def _given(self, name: str) -> str:
        return f"not {brief(self.fields[name])}" if name in self.fields else "it is missing"


def parse(text: str | bytes) -> dict[str, Any]:
    """The JSON object in a WebSocket message; RequestError for anything else."""
    if not isinstance(text, str):
        raise RequestError("binary messages are not understood here; send JSON text")
    try:
        value = loads(text)
    except (ValueError, RecursionError) as error:
        raise RequestError(f"not JSON: {str(error)[:100]}") from None
    if type(value) is not dict:
        raise RequestError("a request is a JSON object")
    return value


def refuse_constant(name: str) -> None:
    """Python reads NaN and Infinity, which are no JSON."""
    raise ValueError(f"{name} is not a JSON value")


def finite(digits: str) -> float:
    """Python reads 1e999 as infinity, which no reply could carry."""
    number = float(digits)
    if math.isinf(number):
        raise ValueError(f"{digits[:20]} is too large a number")
    return number


loads = json.JSONDecoder(parse_constant=refuse_constant, parse_float=finite).decode


def status(level: str, message: str, request_id: Id = None) -> str:
    """The protocol's status operation."""
    return dumps(with_id({"op": "status", "level": level, "msg": message}, request_id))


def with_id(operation: dict[str, Any], request_id: Id) -> dict[str, Any]:
    """`operation` with the id of the request that it answers, if that had one."""
    return operation if request_id is None else {**operation, "id": request_id}


def brief(value: Any) -> str:
    """A JSON value for an error text: never long."""
    try:
        text = dumps(value)
    except RecursionError:
        return "a deeply nested value"
    return text if len(text) <= 60 else text[:57] + "..."
