"""Does a JSON value fit a field? Functions that make bytes of it answer None when not; then the refusals say why."""

import math
import struct
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

import genpy

from server.messages.base64_text import decoded
from server.messages.layout import ANY_LENGTH, SCALARS, Scalar, is_bytes, refuse
from server.websocket.requests import brief

Now = Callable[[], genpy.Time]

# Numbers from here on are no float32: the largest one and half a step.
FLOAT32_END = (2 - 2**-24) * 2.0**127
# What an array's elements may be. Python's truth values are integers, too, ROS's are not.
ALLOWED: Mapping[str, set[type]] = {"integer": {int}, "number": {int, float}, "boolean": {bool}}


def number(value: Any) -> float | None:
    """A number as float, NaN for null; None for what is neither, and for integers beyond every float."""
    if value is None:
        return math.nan
    try:
        return float(value) if type(value) in (int, float) else None
    except OverflowError:
        return None


def utf8(value: Any) -> bytes | None:
    """Text as bytes; None for what is no text, or has half a surrogate pair."""
    try:
        return value.encode() if type(value) is str else None
    except UnicodeEncodeError:
        return None


def seconds(value: Any, scalar: Scalar, now: Now) -> tuple[int, int] | None:
    """(secs, nsecs) of a time or duration, nsecs below a second; None for what is neither."""
    if value == "now" and scalar.name == "time":
        time = now()
        return time.secs, time.nsecs
    if type(value) is not dict or not value.keys() <= {"secs", "nsecs"}:
        return None
    secs, nsecs = value.get("secs", 0), value.get("nsecs", 0)
    if type(secs) is not int or type(nsecs) is not int or not fits("int32", nsecs):
        return None
    secs, nsecs = secs + nsecs // 10**9, nsecs % 10**9
    return (secs, nsecs) if fits(seconds_type(scalar), secs) else None


def seconds_type(scalar: Scalar) -> str:
    return "uint32" if scalar.name == "time" else "int32"


def fits(integer: str, value: int) -> bool:
    low, high = SCALARS[integer].limits
    return low <= value <= high


def array(value: Any, element: Scalar, length: int) -> bytes | None:
    """An array of numbers or truth values; None for what is none, or has an element that does not fit."""
    if type(value) is str and is_bytes(element):
        try:
            data = decoded(value)
        except ValueError:
            return None
        return data if length in (ANY_LENGTH, len(data)) else None
    if type(value) is not list or length not in (ANY_LENGTH, len(value)):
        return None
    types = {*map(type, value)}
    if element.kind == "number" and type(None) in types:
        value = [math.nan if item is None else item for item in value]
        types.discard(type(None))
    try:
        return struct.pack(f"<{len(value)}{element.code}", *value) if types <= ALLOWED[element.kind] else None
    except (struct.error, OverflowError):
        return None


def refuse_object(value: Any, place: str, type_name: str, fields: frozenset[str]) -> NoReturn:
    if type(value) is not dict:
        refuse(place or type_name, f"an object of type {type_name} is needed, not {brief(value)}")
    unknown = next(name for name in value if name not in fields)
    refuse(place, f"{type_name} has no field {unknown[:80]!r}")


def refuse_scalar(value: Any, place: str, scalar: Scalar) -> NoReturn:
    if scalar.kind == "integer":
        low, high = scalar.limits
        refuse(place, f"{scalar.name} is a whole number from {low} to {high}, not {brief(value)}")
    if scalar.kind == "boolean":
        refuse(place, f"true or false is needed, not {brief(value)}")
    if scalar.kind == "number":
        if type(value) in (int, float):
            refuse(place, f"{brief(value)} is too large for {scalar.name}")
        refuse(place, f"a number is needed, not {brief(value)}")
    if scalar.kind == "string":
        if type(value) is str:
            refuse(place, f"{brief(value)} has half a surrogate pair")
        refuse(place, f"a string is needed, not {brief(value)}")
    refuse_time(value, place, scalar)


def refuse_time(value: Any, place: str, scalar: Scalar) -> NoReturn:
    now = ' or "now"' if scalar.name == "time" else ""
    if type(value) is not dict or not value.keys() <= {"secs", "nsecs"}:
        refuse(place, f'{{"secs": int, "nsecs": int}}{now} is needed, not {brief(value)}')
    nsecs = value.get("nsecs", 0)
    if type(nsecs) is not int or not fits("int32", nsecs):
        refuse_scalar(nsecs, f"{place}.nsecs", SCALARS["int32"])
    refuse_scalar(value.get("secs", 0), f"{place}.secs", SCALARS[seconds_type(scalar)])


def refuse_array(value: Any, place: str, element: Scalar, length: int) -> NoReturn:
    if type(value) is str and is_bytes(element):
        try:
            size = len(decoded(value))
        except ValueError as error:
            refuse(place, f"{brief(value)} is {error}")
        refuse(place, f"{length} bytes are needed, not {size}")
    refuse_list(value, place, length)
    wrong = next(index for index, item in enumerate(value) if array([item], element, 1) is None)
    refuse_scalar(value[wrong], f"{place}[{wrong}]", element)


def refuse_list(value: Any, place: str, length: int) -> None:
    if type(value) is not list:
        refuse(place, f"a list is needed, not {brief(value)}")
    if length not in (ANY_LENGTH, len(value)):
        refuse(place, f"{length} elements are needed, not {len(value)}")
