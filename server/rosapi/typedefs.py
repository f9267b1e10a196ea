"""What a message type is made of, as the fields of rosapi/TypeDef.

Arrays: the field's type is the element's, and its length is 0 when any length will do, -1 when it is no array.
Examples are the default values as Python writes them: "0", "0.0", "False", "", "[]" for arrays, "{}" for messages.
"""

import inspect
from typing import Any

from server.messages.layout import SCALARS
from server.messages.types import Types

TypeDef = dict[str, Any]

TIMES = {"time", "duration"}
SIMPLE = SCALARS.keys() - TIMES


def message_typedefs(types: Types, name: str) -> list[TypeDef]:
    """The message type `name` and all that it contains, each once. ConversionError for a type that is unknown here."""
    return _typedefs(types, name, set())


def class_typedefs(types: Types, message_class: type[Any]) -> list[TypeDef]:
    """The same of a generated class: a service's request or response."""
    return _with_contents(types, _typedef(message_class), set())


def _typedefs(types: Types, name: str, seen: set[str]) -> list[TypeDef]:
    if name in seen or name in SIMPLE:
        return []
    seen.add(name)
    typedef = _time(name) if name in TIMES else _typedef(types.message(name).message_class)
    return _with_contents(types, typedef, seen)


def _with_contents(types: Types, typedef: TypeDef, seen: set[str]) -> list[TypeDef]:
    return [typedef, *(inner for field in typedef["fieldtypes"] for inner in _typedefs(types, field, seen))]


def _typedef(message_class: type[Any]) -> TypeDef:
    defaults = message_class()
    names = list(message_class.__slots__)
    kinds = [_kind(slot) for slot in message_class._slot_types]
    constants = {
        name: str(value)
        for name, value in inspect.getmembers(message_class, lambda member: not callable(member))
        if not name.startswith("_") and name not in names
    }
    return {
        "type": message_class._type,
        "fieldnames": names,
        "fieldtypes": [kind for kind, _ in kinds],
        "fieldarraylen": [length for _, length in kinds],
        "examples": [
            _example(kind, length, getattr(defaults, name)) for name, (kind, length) in zip(names, kinds, strict=True)
        ],
        "constnames": list(constants),
        "constvalues": list(constants.values()),
    }


def _kind(slot: str) -> tuple[str, int]:
    """The type and the array length of a field of the type `slot`: "int32[4]"."""
    element, bracket, length = slot.partition("[")
    return element, int(length.rstrip("]") or 0) if bracket else -1


def _example(kind: str, length: int, default: Any) -> str:
    if length >= 0:
        return "[]"
    return str(default) if kind in SIMPLE else "{}"


def _time(name: str) -> TypeDef:
    return {
        "type": name,
        "fieldnames": ["secs", "nsecs"],
        "fieldtypes": ["int32", "int32"],
        "fieldarraylen": [-1, -1],
        "examples": ["0", "0"],
        "constnames": [],
        "constvalues": [],
    }
