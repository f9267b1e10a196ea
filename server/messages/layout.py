"""What a ROS message type is made of, from its generated class (wiki.ros.org/msg)."""

import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn

from server.websocket.requests import RequestError

ARRAY = re.compile(r"(?P<element>[^\[]+)\[(?P<length>\d*)\]")
ANY_LENGTH = -1


class ConversionError(RequestError):
    """A value does not fit the ROS type, or there is no such type; the text says what and where."""


@dataclass(frozen=True)
class Scalar:
    """A built-in type. `code`: its numbers for the module struct; a string has the code of its length."""

    name: str
    kind: str  # integer, number, boolean, string or time
    code: str

    @cached_property
    def size(self) -> int:
        """Bytes, of a string at least."""
        return struct.calcsize(f"<{self.code}")

    @cached_property
    def limits(self) -> tuple[int, int]:
        """Smallest and largest integer."""
        bits = 8 * self.size
        return (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if self.code.islower() else (0, 2**bits - 1)


@dataclass(frozen=True)
class Field:
    """A field of a message. `length`: None for a single value, ANY_LENGTH or the number of an array's elements."""

    name: str
    type: "Scalar | Layout"
    length: int | None


@dataclass(frozen=True)
class Layout:
    """The fields of a message type, in the order of their bytes."""

    name: str
    fields: tuple[Field, ...]

    @cached_property
    def size(self) -> int:
        """Bytes of a message at least."""
        return sum(
            4 if field.length == ANY_LENGTH else field.type.size * (1 if field.length is None else field.length)
            for field in self.fields
        )


INTEGERS = {
    **{"int8": "b", "byte": "b", "uint8": "B", "char": "B", "int16": "h", "uint16": "H"},
    **{"int32": "i", "uint32": "I", "int64": "q", "uint64": "Q"},
}
SCALARS = {
    **{name: Scalar(name, "integer", code) for name, code in INTEGERS.items()},
    "bool": Scalar("bool", "boolean", "?"),
    "float32": Scalar("float32", "number", "f"),
    "float64": Scalar("float64", "number", "d"),
    "string": Scalar("string", "string", "I"),
    "time": Scalar("time", "time", "II"),
    "duration": Scalar("duration", "time", "ii"),
}


def layout_of(name: str, message_class: type[Any], find: Callable[[str], Layout]) -> Layout:
    """The layout of a generated class. `find` gives the layouts of the message types in it."""
    fields = []
    for field, field_type in zip(message_class.__slots__, message_class._slot_types, strict=True):
        array = ARRAY.fullmatch(field_type)
        element, length = (array["element"], int(array["length"] or ANY_LENGTH)) if array else (field_type, None)
        # the .msg language allows a bare Header
        full_name = "std_msgs/Header" if element == "Header" else element
        fields.append(Field(field, SCALARS.get(element) or find(full_name), length))
    return Layout(name, tuple(fields))


def is_bytes(element: Scalar | Layout) -> bool:
    """Arrays of it are blobs: base64 in JSON (rosbridge protocol 4.6)."""
    return element is SCALARS["uint8"] or element is SCALARS["char"]


def is_long_by_bytes(layout: Layout) -> bool:
    """Whether a long message of that type is long by a blob or a text, as far as the type tells."""
    arrays = list(_arrays(layout))
    return not arrays or any(map(is_bytes, arrays))


def _arrays(layout: Layout) -> Iterator[Scalar | Layout]:
    """The elements of all arrays in a message."""
    for field in layout.fields:
        if field.length is not None:
            yield field.type
        if isinstance(field.type, Layout):
            yield from _arrays(field.type)


def refuse(place: str, reason: str) -> NoReturn:
    """`place` in the message ("layout.dim[0].size"); empty for the message itself."""
    raise ConversionError(f"{place}: {reason}" if place else reason)
