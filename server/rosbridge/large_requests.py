"""Requests that take long to read become short ones outside the event loop: a message is there as ROS gets it."""

import pickle
from collections.abc import Mapping
from typing import Any, NamedTuple

import genpy

from server.messages.fitting import Now
from server.messages.types import ConversionError, MessageType, known_service, known_type
from server.rosbridge.compression import from_png
from server.rosbridge.stream import RequestStream
from server.websocket.requests import Request, RequestError, parse

LARGE_TEXT = 64 * 2**10  # characters; shorter ones are read in a few ms
WRAPPERS = ("fragment", "png")


class Packed(NamedTuple):
    """The value of a message's field: serialized, or why it could not be."""

    type: str
    data: bytes
    error: str = ""

    def __str__(self) -> str:
        return self.error or f"a {self.type}"


class Kept(NamedTuple):
    """The arguments of a call, whose type only the service itself will tell: for `packed_request`."""

    data: bytes


def unpacked(
    text: str, wrapper: str, types: Mapping[str, str], responses: Mapping[str, str], now: int
) -> dict[str, Any]:
    """The fields of the request in `text`, in which the message of a publish and the values of a response are Packed
    if their type is known, and the arguments of a call Kept.

    `types`: those of the topics in use, by name; `responses`: those that the client owes, by the calls' ids; `now`:
    ROS's time, ns. RequestError when there is no request.
    """
    return _prepared(parse(text), wrapper, types, responses, now)


def read(
    stream: RequestStream, data: str | bytes, types: Mapping[str, str], responses: Mapping[str, str], now: int
) -> tuple[list[dict[str, Any] | RequestError], RequestStream]:
    """All requests in `data`, as `unpacked` makes them, and why something is none; the stream behind it."""
    found: list[dict[str, Any] | RequestError] = []
    for each in stream.feed(data):
        if isinstance(each, RequestError):
            found.append(each)
            continue
        try:
            fields = parse(each) if isinstance(each, str) else each
            found.append(_prepared(fields, "", types, responses, now))
        except RequestError as error:
            found.append(error)
    return found, stream


def _prepared(
    fields: dict[str, Any], wrapper: str, types: Mapping[str, str], responses: Mapping[str, str], now: int
) -> dict[str, Any]:
    if fields.get("op") == "png" and wrapper != "png":
        fields, wrapper = parse(from_png(Request(fields).text("data"))), "png"
    refuse_nested(fields, wrapper)
    request = Request(fields)
    match fields.get("op"):
        case "publish":
            name = types.get(request.ros_name("topic")) or request.ros_type("")
            if name:
                fields["msg"] = _packed(name, fields.get("msg", {}), now)
        case "service_response" if type(fields.get("values")) is dict and request.id in responses:
            fields["values"] = _packed(responses[request.id], fields["values"], now)  # type: ignore[index]
        case "call_service" if type(fields.get("args")) in {dict, list}:
            fields["args"] = Kept(pickle.dumps(fields["args"]))
    return fields


def packed_request(service: str, args: bytes, now: int) -> bytes:
    """A request of that type, with arguments that were Kept. ConversionError when they do not fit."""
    return known_service(service).pack_request(pickle.loads(args), lambda: genpy.Time(0, now))


def refuse_nested(fields: Mapping[str, Any], wrapper: str) -> None:
    """Never the same wrapper again, so that it ends. A picture may come in parts."""
    if wrapper and (fields.get("op") == wrapper or (wrapper == "png" and fields.get("op") in WRAPPERS)):
        raise RequestError(f"a {wrapper} within a {wrapper} is not understood")


def serialized(message_type: MessageType, value: Any, now: Now) -> bytes:
    """What ROS gets. ConversionError when the value does not fit."""
    if type(value) is not Packed:
        return message_type.pack(value, now)
    if value.error:
        raise ConversionError(value.error)
    if value.type != message_type.name:
        raise ConversionError(f"the message is a {value.type}, not a {message_type.name}")
    return value.data


def _packed(name: str, value: Any, now: int) -> Packed:
    try:
        return Packed(name, known_type(name).pack(value, lambda: genpy.Time(0, now)))
    except ConversionError as error:
        return Packed(name, b"", str(error))
