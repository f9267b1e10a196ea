"""ROS messages as JSON values and back (rosbridge protocol 4.6; field types of the ROS .msg language).

| field type | JSON, to and from |
|---|---|
| bool | true, false |
| int8..uint64, byte (= int8), char (= uint8) | a number without fraction, in range |
| float32, float64 | a number; NaN and infinities are sent as null, and refused when received |
| string | a string |
| time, duration | {"secs": int, "nsecs": int} |
| uint8[], char[], uint8[N], char[N] | base64 string; a list of numbers is understood too |
| other arrays | a list |
| message | an object; unknown fields are refused, missing ones keep their default |
"""

import base64
import binascii
import math
import re
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import genpy
import roslib.message

from server.rosbridge.wire import RequestError, brief

INTEGERS = {
    "int8": (-(2**7), 2**7 - 1),
    "byte": (-(2**7), 2**7 - 1),
    "uint8": (0, 2**8 - 1),
    "char": (0, 2**8 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint64": (0, 2**64 - 1),
}
TYPE_NAME = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*", re.ASCII)
ARRAY = re.compile(r"(?P<element>[^\[]+)\[(?P<length>\d*)\]")

Decoder = Callable[[Any, str], Any]  # (JSON value, place in the message for the error) -> value; ConversionError
Encoder = Callable[[Any], Any]  # value of the field -> JSON value


class ConversionError(RequestError):
    """A JSON value does not fit the ROS type, or there is no such type; the text says what and where."""


@dataclass(frozen=True, slots=True)
class MessageType:
    """One ROS message type."""

    name: str
    message_class: type[Any]
    decode: Decoder  # JSON object -> message
    encode: Callable[[Any], dict[str, Any]]  # message -> JSON object


@dataclass(frozen=True, slots=True)
class ServiceType:
    """One ROS service type."""

    name: str
    md5sum: str
    request: MessageType
    response: MessageType


class Types:
    """The message and service types of this machine's ROS packages, looked up once each."""

    def __init__(self) -> None:
        self._messages: dict[str, MessageType] = {}
        self._services: dict[str, ServiceType] = {}

    def message(self, name: str) -> MessageType:
        """The message type `name` ("std_msgs/String"); ConversionError when this machine has no such type."""
        if name not in self._messages:
            self._messages[name] = self._compile(name, find_class(roslib.message.get_message_class, name, "message"))
        return self._messages[name]

    def service(self, name: str) -> ServiceType:
        """The service type `name` ("std_srvs/Empty"); ConversionError when this machine has no such type."""
        if name not in self._services:
            service = find_class(roslib.message.get_service_class, name, "service")
            self._services[name] = ServiceType(
                name,
                service._md5sum,
                self._compile(name + "Request", service._request_class),
                self._compile(name + "Response", service._response_class),
            )
        return self._services[name]

    def _compile(self, name: str, message_class: type[Any]) -> MessageType:
        fields = list(zip(message_class.__slots__, message_class._slot_types, strict=True))
        decoders = {field: self._decoder(field_type) for field, field_type in fields}
        encoders = [(field, self._encoder(field_type)) for field, field_type in fields]

        def decode(value: Any, where: str) -> Any:
            if type(value) is not dict:
                raise ConversionError(f"{where or name}: an object of type {name} is needed, not {brief(value)}")
            message = message_class()
            for field, content in value.items():
                decoder = decoders.get(field)
                if decoder is None:
                    raise ConversionError(f"{name} has no field {field[:80]!r}")
                setattr(message, field, decoder(content, f"{where}.{field}" if where else field))
            return message

        def encode(message: Any) -> dict[str, Any]:
            return {field: encoder(getattr(message, field)) for field, encoder in encoders}

        return MessageType(name, message_class, decode, encode)

    def _decoder(self, field_type: str) -> Decoder:
        if array := ARRAY.fullmatch(field_type):
            element, length = array["element"], int(array["length"] or -1)
            if element in ("uint8", "char"):
                return byte_array_decoder(length)
            return array_decoder(self._decoder(element), length)
        if field_type in SCALAR_DECODERS:
            return SCALAR_DECODERS[field_type]
        return self.message(full_name(field_type)).decode

    def _encoder(self, field_type: str) -> Encoder:
        if array := ARRAY.fullmatch(field_type):
            element = array["element"]
            if element in ("uint8", "char"):
                return encode_bytes
            if element in INTEGERS or element in ("bool", "string"):
                return list
            return array_encoder(self._encoder(element))
        if field_type in SCALAR_ENCODERS:
            return SCALAR_ENCODERS[field_type]
        return self.message(full_name(field_type)).encode


def find_class(find: Callable[[str], type[Any] | None], name: str, kind: str) -> type[Any]:
    """The generated class of a type name; ConversionError for a malformed or unknown name."""
    if not TYPE_NAME.fullmatch(name):
        raise ConversionError(f"{name[:80]!r} is not a {kind} type; write package/Name")
    found = find(name)
    if found is None:
        raise ConversionError(f"the {kind} type {name[:80]} is unknown here")
    return found


def full_name(field_type: str) -> str:
    """The .msg language allows a bare Header."""
    return "std_msgs/Header" if field_type == "Header" else field_type


def integer_decoder(name: str) -> Decoder:
    low, high = INTEGERS[name]

    def decode(value: Any, where: str) -> int:
        if type(value) is not int or not low <= value <= high:
            raise ConversionError(f"{where}: {name} is a whole number from {low} to {high}, not {brief(value)}")
        return value

    return decode


def decode_bool(value: Any, where: str) -> bool:
    if type(value) is not bool:
        raise ConversionError(f"{where}: true or false is needed, not {brief(value)}")
    return value


def decode_float64(value: Any, where: str) -> float:
    if type(value) not in (int, float):
        raise ConversionError(f"{where}: a number is needed, not {brief(value)}")
    try:
        return float(value)
    except OverflowError:
        raise ConversionError(f"{where}: {brief(value)} is too large for float64") from None


def decode_float32(value: Any, where: str) -> float:
    number = decode_float64(value, where)
    try:
        struct.pack("<f", number)
    except OverflowError:
        raise ConversionError(f"{where}: {number} is too large for float32") from None
    return number


def decode_string(value: Any, where: str) -> str:
    if type(value) is not str:
        raise ConversionError(f"{where}: a string is needed, not {brief(value)}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ConversionError(f"{where}: {brief(value)} has half a surrogate pair") from None
    return value


def time_decoder(time_class: type[Any], seconds: str) -> Decoder:
    """genpy's times normalise nsecs, so that only the seconds' range (uint32 or int32) can be left."""
    decode_seconds, decode_nanoseconds = integer_decoder(seconds), integer_decoder("int32")

    def decode(value: Any, where: str) -> Any:
        if type(value) is not dict or not value.keys() <= {"secs", "nsecs"}:
            raise ConversionError(f'{where}: {{"secs": int, "nsecs": int}} is needed, not {brief(value)}')
        secs = decode_seconds(value.get("secs", 0), f"{where}.secs")
        nsecs = decode_nanoseconds(value.get("nsecs", 0), f"{where}.nsecs")
        try:
            time = time_class(secs, nsecs)
        except (TypeError, ValueError) as error:
            raise ConversionError(f"{where}: {error}") from None
        decode_seconds(time.secs, f"{where}.secs")
        return time

    return decode


def byte_array_decoder(length: int) -> Decoder:
    """`length` -1: any. rosbridge protocol 4.6."""
    decode_list = array_decoder(integer_decoder("uint8"), length)

    def decode(value: Any, where: str) -> bytes:
        if type(value) is not str:
            return bytes(decode_list(value, where))
        try:
            data = base64.b64decode(value, validate=True)
        except (binascii.Error, ValueError):
            raise ConversionError(f"{where}: {brief(value)} is not base64") from None
        if length not in (-1, len(data)):
            raise ConversionError(f"{where}: {length} bytes are needed, not {len(data)}")
        return data

    return decode


def array_decoder(decode_element: Decoder, length: int) -> Decoder:
    def decode(value: Any, where: str) -> list[Any]:
        if type(value) is not list:
            raise ConversionError(f"{where}: a list is needed, not {brief(value)}")
        if length not in (-1, len(value)):
            raise ConversionError(f"{where}: {length} elements are needed, not {len(value)}")
        return [decode_element(element, f"{where}[{index}]") for index, element in enumerate(value)]

    return decode


def array_encoder(encode_element: Encoder) -> Encoder:
    return lambda values: [encode_element(value) for value in values]


def encode_same(value: Any) -> Any:
    return value


def encode_float(value: float) -> float | None:
    return value if math.isfinite(value) else None


def encode_time(value: Any) -> dict[str, int]:
    return {"secs": value.secs, "nsecs": value.nsecs}


def encode_bytes(value: bytes | list[int]) -> str:
    return base64.b64encode(bytes(value)).decode("ascii")


SCALAR_DECODERS: Mapping[str, Decoder] = {
    **{name: integer_decoder(name) for name in INTEGERS},
    "bool": decode_bool,
    "float32": decode_float32,
    "float64": decode_float64,
    "string": decode_string,
    "time": time_decoder(genpy.Time, "uint32"),
    "duration": time_decoder(genpy.Duration, "int32"),
}
SCALAR_ENCODERS: Mapping[str, Encoder] = {
    **dict.fromkeys(INTEGERS, encode_same),
    "bool": encode_same,
    "string": encode_same,
    "float32": encode_float,
    "float64": encode_float,
    "time": encode_time,
    "duration": encode_time,
}
