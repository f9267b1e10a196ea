"""ROS messages as JSON values and back (rosbridge protocol 4.6; field types of the ROS .msg language).

| field type | JSON, to and from |
|---|---|
| bool | true, false |
| int8..uint64, byte (= int8), char (= uint8) | a number without fraction, in range |
| float32, float64 | a number; NaN and infinities are sent as null, and null is received as NaN |
| string | a string |
| time, duration | {"secs": int, "nsecs": int}; "now" is understood for a time |
| uint8[], char[], uint8[N], char[N] | base64 string; a list of numbers is understood too |
| other arrays | a list |
| message | an object; unknown fields are refused, missing ones have their default |

The stamp of a std_msgs/Header has now as its default (rosbridge protocol 3.2.3).
"""

import importlib.util
import os
import re
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from server.messages.fitting import Now
from server.messages.layout import ConversionError, Layout, is_long_by_bytes, layout_of
from server.messages.packing import Pack, packer
from server.messages.unpacking import CborValues, JsonText, Values, unpacker

__all__ = ["ConversionError", "MessageType", "ServiceType", "Types"]

TYPE_NAME = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*", re.ASCII)
# A type that is missing may be installed meanwhile; asking costs a look into every folder of Python's path.
ASK_AGAIN = 1.0  # s
MAX_MISSING = 1000  # names that are remembered


class MessageType:
    """One ROS message type. The functions are made when they are first used; all raise ConversionError."""

    def __init__(self, layout: Layout, message_class: type[Any]) -> None:
        self.name = layout.name
        self.message_class = message_class
        self.md5sum: str = message_class._md5sum
        self.definition: str = message_class._full_text  # with the definitions of the messages in it
        self.fields = tuple(field.name for field in layout.fields)
        self.is_long_by_bytes = is_long_by_bytes(layout)
        self._layout = layout

    def __reduce__(self) -> tuple[Callable[[str], "MessageType"], tuple[str]]:
        """Another process has the type by its name."""
        return known_type, (self.name,)

    @cached_property
    def pack(self) -> Pack:
        """(JSON object, clock) -> serialized message, without its length."""
        return packer(self._layout)

    @cached_property
    def values(self) -> Callable[[bytes], dict[str, Any]]:
        """Serialized message -> JSON object."""
        return unpacker(self._layout, Values())

    @cached_property
    def json(self) -> Callable[[bytes], str]:
        """Serialized message -> JSON text, without spaces."""
        return unpacker(self._layout, JsonText())

    @cached_property
    def cbor(self) -> Callable[[bytes], dict[str, Any]]:
        """Serialized message -> object for cbor2."""
        return unpacker(self._layout, CborValues())


@dataclass(frozen=True, slots=True)
class ServiceType:
    """One ROS service type."""

    name: str
    md5sum: str
    request: MessageType
    response: MessageType

    def pack_request(self, args: Any, now: Now) -> bytes:
        """The serialized request. `args`: a JSON object, a list of the first fields in their order, or None; what is
        missing has its default. ConversionError when they do not fit."""
        if args is None:
            args = {}
        if type(args) is list:
            fields = self.request.fields
            if len(args) > len(fields):
                names = f" ({', '.join(fields)})" if fields else ""
                raise ConversionError(f"{self.name} takes {len(fields)} arguments{names}, not {len(args)}")
            args = dict(zip(fields, args, strict=False))
        return self.request.pack(args, now)


class Types:
    """The message and service types of the ROS packages on Python's path, looked up once each. A type that is missing
    is asked for again: its package may be installed while rosbridge runs."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._messages: dict[str, MessageType] = {}
        self._services: dict[str, ServiceType] = {}
        self._missing: dict[tuple[str, str], tuple[float, str]] = {}  # (folder, name) -> when, why
        self._looked = -ASK_AGAIN

    def message(self, name: str) -> MessageType:
        """The message type `name` ("std_msgs/String"); ConversionError when this machine has no such type."""
        if name not in self._messages:
            self._messages[name] = self._compile(name, self._find("msg", name))
        return self._messages[name]

    def service(self, name: str) -> ServiceType:
        """The service type `name` ("std_srvs/Empty"); ConversionError when this machine has no such type."""
        if name not in self._services:
            service = self._find("srv", name)
            self._services[name] = ServiceType(
                name,
                service._md5sum,
                self._compile(name + "Request", service._request_class),
                self._compile(name + "Response", service._response_class),
            )
        return self._services[name]

    def _compile(self, name: str, message_class: type[Any]) -> MessageType:
        layout = layout_of(name, message_class, lambda inner: self.message(inner)._layout)
        return MessageType(layout, message_class)

    def _find(self, folder: str, name: str) -> type[Any]:
        now, key = self._clock(), (folder, name)
        asked, reason = self._missing.get(key, (now - ASK_AGAIN, ""))
        if now - asked < ASK_AGAIN:
            raise ConversionError(reason)
        if now - self._looked >= ASK_AGAIN:
            importlib.invalidate_caches()
            self._looked = now
        try:
            found = find_class(folder, name)
        except ConversionError as error:
            if len(self._missing) >= MAX_MISSING:
                self._missing.clear()
            self._missing[key] = now, str(error)
            raise
        self._missing.pop(key, None)
        return found


@cache
def _types() -> Types:
    return Types()


def known_type(name: str) -> MessageType:
    """A message's type, or that of a service's request or response."""
    for end, part in (("Request", "request"), ("Response", "response")):
        if name.endswith(end):
            with suppress(ConversionError):
                found: MessageType = getattr(_types().service(name.removesuffix(end)), part)
                return found
    return _types().message(name)


def known_service(name: str) -> ServiceType:
    return _types().service(name)


def find_class(folder: str, name: str) -> type[Any]:
    """The class that genpy has generated for a type name; `folder`: msg or srv. ConversionError for a malformed or
    unknown name, or when the class cannot be loaded.

    genpy's own search would import any Python package that a client names, and would keep to a package's list of
    messages from its first import.
    """
    kind = {"msg": "message", "srv": "service"}[folder]
    if len(name) > 200 or not TYPE_NAME.fullmatch(name):
        raise ConversionError(f"{name[:80]!r} is not a {kind} type; write package/Name")
    package, base = name.split("/")
    found, module = None, f"{package}.{folder}._{base}"
    if has_folder(package, folder):
        try:
            found = getattr(importlib.import_module(module), base, None)
        except Exception as error:  # whatever the generated code, or half of it, may raise
            if not isinstance(error, ModuleNotFoundError) or error.name != module:
                raise ConversionError(f"the {kind} type {name[:80]} cannot be loaded: {error}") from None
    if not hasattr(found, "_md5sum"):
        sys.modules.pop(module, None)  # it may be half written: next time it is looked at again
        raise ConversionError(f"the {kind} type {name[:80]} is unknown here")
    return found  # type: ignore[return-value]


def has_folder(package: str, folder: str) -> bool:
    """Is it a Python package with such a folder? The package is not imported for that."""
    try:
        spec = importlib.util.find_spec(package)
    except (ImportError, ValueError):
        return False
    places = (spec and spec.submodule_search_locations) or ()
    return any(os.path.isdir(os.path.join(place, folder)) for place in places)
