"""JSON text on the WebSocket: strict parsing of requests, compact writing of replies."""

import json
import math
import re
import sys
from typing import Any

from laser_bot_battle.names import ROSBRIDGE_NODE

dumps = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode
loads = json.JSONDecoder().decode

# What ROS has in use is more than its naming rules allow: the master takes any name, and nodes of all languages are
# careless.
ROS_NAME = re.compile(r"[/~]?[^\s/~]+(/[^\s/~]+)*")
SURROGATE = re.compile("[\ud800-\udfff]")
MAX_NAME = 200  # characters
MAX_NUMBER = 1e9
MOST_FINITE = sys.float_info.max
MAX_LINE = 300  # characters
MAX_ID = 256  # characters: it is kept, and comes back with every answer

# A request's id may be text or a number: some languages know no whole ones.
Id = str | int | float | None


class RequestError(Exception):
    """A client's request cannot be done; the text tells the client why."""


class Request:
    """One operation of a client: typed access to its fields, RequestError where they are missing or wrong."""

    __slots__ = ("fields", "id")

    def __init__(self, fields: dict[str, Any]) -> None:
        self.fields = fields
        given = fields.get("id")
        if type(given) not in (str, int, float) or (type(given) is float and not math.isfinite(given)):
            given = None
        elif len(given if type(given) is str else str(given)) > MAX_ID:
            raise RequestError(f"an id may have {MAX_ID} characters")
        elif type(given) is str and SURROGATE.search(given):  # which CBOR cannot give back
            raise RequestError("the id has half a surrogate pair")
        self.id: Id = given

    def text(self, name: str, most: int | None = None) -> str:
        """A string that must be there, of so many characters at most."""
        value = self.fields.get(name)
        if type(value) is not str:
            raise RequestError(f"the field {name!r} must be a string, {self._given(name)}")
        if most is not None and len(value) > most:
            raise RequestError(f"the field {name!r} has more than {most} characters")
        return value

    def ros_name(self, name: str) -> str:
        """The global ROS name that must be there: rosbridge lives in the root namespace. Whatever is compared with a
        topic or service (the gate's rules above all) must be compared with this form."""
        value = self.text(name)
        canonical = value.rstrip("/").replace("//", "/") if "/" in value[1:] else value
        if not is_ros_name(canonical) or len(value) > MAX_NAME:
            raise RequestError(f"{brief(value)} is not a ROS name")
        if canonical.startswith("~"):
            return f"/{ROSBRIDGE_NODE}/{canonical[1:]}"
        return canonical if canonical.startswith("/") else f"/{canonical}"

    def ros_type(self, default: str | None = None) -> str:
        """The name of a message's or service's type, "package/Name"; upstream overlooks further slashes, and libraries
        that also know ROS 2 write "package/msg/Name". Without a default it must be there."""
        value = self.text("type") if default is None else self.optional_text("type", default)
        parts = [part for part in value.split("/") if part]
        if len(parts) == 3 and parts[1] in ("msg", "srv"):
            del parts[1]
        return "/".join(parts)

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
        """A number from 0 to MAX_NUMBER; what is below or above counts as that."""
        value = self.fields.get(name)
        if value is None:
            return default
        if type(value) not in (int, float) or not abs(value) <= MOST_FINITE:  # or NaN
            raise RequestError(f"the field {name!r} must be a number, {self._given(name)}")
        return float(min(max(value, 0), MAX_NUMBER))

    def flag(self, name: str) -> bool:
        """True or false, false when missing; of other values what Python makes of them, as upstream."""
        return bool(self.fields.get(name))

    def _given(self, name: str) -> str:
        return f"not {brief(self.fields[name])}" if name in self.fields else "it is missing"


def is_ros_name(name: str) -> bool:
    """Whether clients can use what the ROS master lists by this name."""
    return len(name) <= MAX_NAME and name.isprintable() and ROS_NAME.fullmatch(name) is not None


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


def status(level: str, message: str, request_id: Id = None) -> str:
    """The protocol's status operation."""
    return dumps(with_id({"op": "status", "level": level, "msg": message}, request_id))


def with_id(operation: dict[str, Any], request_id: Id) -> dict[str, Any]:
    """`operation` with the id of the request that it answers, if that had one."""
    return operation if request_id is None else {**operation, "id": request_id}


def brief(value: Any) -> str:
    """A JSON value for an error text: never long."""
    try:
        text = json.dumps(value)
    except RecursionError:
        return "a deeply nested value"
    except ValueError:
        return "a huge number"
    return text if len(text) <= 60 else text[:57] + "..."


def one_line(text: str) -> str:
    """Text for the log that may be a client's: it neither looks like lines of its own, nor fills the log."""
    return text[:MAX_LINE] if text.isprintable() else repr(text[:MAX_LINE])
