"""Serialized ROS messages to JSON text, JSON-able values or CBOR-able values."""

import binascii
import struct
from collections.abc import Callable
from json.encoder import encode_basestring_ascii
from typing import Any

from cbor2 import CBORTag

from server.messages.layout import ANY_LENGTH, ConversionError, Layout, Scalar, is_bytes
from server.messages.source import Source

# Elements without bytes, like std_msgs/Empty[], could be announced by the thousand million.
MAX_EMPTY_ELEMENTS = 10_000
# draft-ietf-cbor-array-tags-00, little endian; the tags that upstream uses
ARRAY_TAGS = {
    **{"int8": 72, "byte": 72, "uint16": 69, "int16": 77, "uint32": 70, "int32": 78, "uint64": 71, "int64": 79},
    **{"float32": 85, "float64": 86},
}


class Values:
    """Expressions whose value is what the module json can write."""

    def is_raw(self, element: Scalar) -> bool:
        """Whether an array of these numbers is read as it is, not taken apart."""
        return False

    def result(self, expression: str) -> str:
        return expression

    def scalar(self, kind: str, variable: str) -> str:
        # not 0 for NaN and infinities, which JSON does not have
        return f"({variable} if {variable} - {variable} == 0 else None)" if kind == "number" else variable

    def members(self, members: dict[str, str]) -> str:
        return "{" + ", ".join(f"{name!r}: {value}" for name, value in members.items()) + "}"

    def blob(self, variable: str) -> str:
        return f"base64({variable})"

    def array(self, element: Scalar, variable: str) -> str:
        return f"{'finite' if element.kind == 'number' else 'list'}({variable})"

    def elements(self, variable: str) -> str:
        return variable


class JsonText(Values):
    """Pieces of an f-string, which is the JSON text. Before Python 3.12 they must be free of single quotes."""

    def result(self, expression: str) -> str:
        return f"f'{expression}'"

    def scalar(self, kind: str, variable: str) -> str:
        expressions = {
            "integer": variable,
            "boolean": f"boolean_words[{variable}]",
            "number": f"({variable} if {variable} - {variable} == 0 else null)",
            "string": f"quote({variable})",
        }
        return "{" + expressions[kind] + "}"

    def members(self, members: dict[str, str]) -> str:
        return "{{" + ",".join(f'"{name}":{value}' for name, value in members.items()) + "}}"

    def blob(self, variable: str) -> str:
        return f'"{{base64({variable})}}"'

    def is_raw(self, element: Scalar) -> bool:
        return element.size == 1 and element.kind == "integer"

    def array(self, element: Scalar, variable: str) -> str:
        return f"{{{'octet' if self.is_raw(element) else element.kind}s({variable})}}"

    def elements(self, variable: str) -> str:
        return f"[{{comma({variable})}}]"


class CborValues(Values):
    """Expressions whose value is what cbor2 can write, as upstream's cbor_conversion.py has it: arrays of numbers are
    tagged bytes, blobs are bytes, NaN stays NaN."""

    def is_raw(self, element: Scalar) -> bool:
        return element.kind != "boolean"

    def scalar(self, kind: str, variable: str) -> str:
        return variable

    def blob(self, variable: str) -> str:
        return variable

    def array(self, element: Scalar, variable: str) -> str:
        return f"list({variable})" if element.kind == "boolean" else f"tag({ARRAY_TAGS[element.name]}, {variable})"


def base64(data: bytes) -> str:
    return binascii.b2a_base64(data, newline=False).decode("ascii")


def finite(numbers: tuple[float, ...]) -> list[float | None]:
    return [number if number - number == 0 else None for number in numbers]


_OCTETS = [f"{octet - 256 if octet > 127 else octet}," for octet in range(256)]


def json_octets(data: bytes) -> str:
    """Of int8, such as the sixteen million cells of a map: a table is thrice as fast as numbers."""
    return f"[{data.decode('latin-1').translate(_OCTETS)[:-1]}]"


def json_integers(integers: tuple[int, ...]) -> str:
    return repr([*integers]).replace(" ", "")


def json_booleans(booleans: tuple[bool, ...]) -> str:
    return repr([*booleans]).replace(" ", "").lower()


def json_numbers(numbers: tuple[float, ...]) -> str:
    text = repr([*numbers]).replace(" ", "")
    if "n" in text:  # nan, inf
        text = text.replace("nan", "null").replace("-inf", "null").replace("inf", "null")
    return text


HELPERS = {
    **{"base64": base64, "finite": finite, "tag": CBORTag, "unpack": struct.unpack_from},
    **{"quote": encode_basestring_ascii, "comma": ",".join, "boolean_words": ("false", "true"), "null": "null"},
    **{"octets": json_octets, "integers": json_integers, "booleans": json_booleans, "numbers": json_numbers},
    "error": ConversionError,
}


class Reader:
    """Writes `read(data)`. A run of fields of fixed size is read by one Struct."""

    def __init__(self, style: Values) -> None:
        self._style = style
        self._source = Source("read(data)", HELPERS)
        self._run: list[tuple[str, list[str]]] = []  # codes for struct, variables

    def function(self, layout: Layout) -> Any:
        self._line("at = 0")
        result = self._message(layout)
        self._read_run()
        self._line("if at != len(data):")
        self._line("    raise error(f'{at} bytes are needed, not {len(data)}')")
        self._line(f"return {self._style.result(result)}")
        return self._source.function("read", f"reader of {layout.name}")

    def _message(self, layout: Layout) -> str:
        members = {}
        for field in layout.fields:
            value = self._single(field.type) if field.length is None else self._array(field.type, field.length)
            members[field.name] = value
        return self._style.members(members)

    def _single(self, element: Scalar | Layout) -> str:
        if isinstance(element, Layout):
            return self._message(element)
        if element.kind == "time":
            secs, nsecs = self._read(element.code, 2)
            return self._style.members(
                {"secs": self._style.scalar("integer", secs), "nsecs": self._style.scalar("integer", nsecs)}
            )
        (variable,) = self._read(element.code, 1)
        if element.kind == "string":
            self._read_run()
            self._slice(variable, variable)
            self._line(f"{variable} = str({variable}, 'utf-8', 'replace')")
        return self._style.scalar(element.kind, variable)

    def _array(self, element: Scalar | Layout, length: int) -> str:
        count = str(length)
        if length == ANY_LENGTH:
            (count,) = self._read("I", 1)
        self._read_run()
        if isinstance(element, Layout) or element.kind in ("string", "time"):
            return self._loop(element, count)
        variable = self._source.variable()
        if is_bytes(element):
            self._slice(variable, count)
            return self._style.blob(variable)
        if self._style.is_raw(element):
            self._slice(variable, f"{count} * {element.size}")
        else:
            self._line(f"{variable} = unpack(f'<{{{count}}}{element.code}', data, at)")
            self._line(f"at += {count} * {element.size}")
        return self._style.array(element, variable)

    def _loop(self, element: Scalar | Layout, count: str) -> str:
        most = f"(len(data) - at) // {element.size}" if element.size else MAX_EMPTY_ELEMENTS
        self._line(f"if {count} > {most}:")
        self._line(f"    raise error(f'{{{count}}} elements cannot be')")
        elements = self._source.variable()
        self._line(f"{elements} = []")
        self._line(f"for _ in range({count}):")
        self._source.depth += 1
        value = self._single(element)
        self._read_run()
        self._line(f"{elements}.append({self._style.result(value)})")
        self._source.depth -= 1
        return self._style.elements(elements)

    def _slice(self, variable: str, size: str) -> None:
        """What is beyond the end of the data shows at the end of the function."""
        end = self._source.variable()
        self._line(f"{end} = at + {size}")
        self._line(f"{variable} = data[at:{end}]")
        self._line(f"at = {end}")

    def _read(self, codes: str, count: int) -> list[str]:
        """New variables, which get their values with the run."""
        variables = [self._source.variable() for _ in range(count)]
        self._run.append((codes, variables))
        return variables

    def _read_run(self) -> None:
        if not self._run:
            return
        run = struct.Struct("<" + "".join(codes for codes, _ in self._run))
        variables = ", ".join(variable for _, variables in self._run for variable in variables)
        self._line(f"{variables}, = {self._source.constant(run.unpack_from)}(data, at)")
        self._line(f"at += {run.size}")
        self._run.clear()

    def _line(self, text: str) -> None:
        self._source.line(text)


def unpacker(layout: Layout, style: Values) -> Callable[[bytes], Any]:
    """A function from a serialized message to what `style` makes of it; ConversionError when the bytes do not fit."""
    read = Reader(style).function(layout)

    def unpack(data: bytes) -> Any:
        try:
            return read(data)
        except (struct.error, ConversionError) as error:
            raise ConversionError(f"the bytes are no {layout.name}: {error}") from None

    return unpack
