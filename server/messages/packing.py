"""JSON values to serialized ROS messages."""

import struct
from collections.abc import Callable
from typing import Any

from server.messages import fitting
from server.messages.fitting import FLOAT32_END, Now
from server.messages.layout import ANY_LENGTH, Layout, Scalar
from server.messages.source import Source

Pack = Callable[[Any, Now], bytes]

# What a missing field is: its default, by kind. A message with all fields missing is an empty object.
DEFAULTS: dict[str, Any] = {"integer": 0, "number": 0.0, "boolean": False, "string": "", "time": {}}
HELPERS = {
    **{"join": b"".join, "array": fitting.array, "number": fitting.number},
    **{"seconds": fitting.seconds, "utf8": fitting.utf8},
    **{"refuse_array": fitting.refuse_array, "refuse_list": fitting.refuse_list},
    **{"refuse_object": fitting.refuse_object, "refuse_scalar": fitting.refuse_scalar},
}


class Writer:
    """Writes `pack(value, now)`. A run of fields of fixed size is written by one Struct."""

    def __init__(self) -> None:
        self._source = Source("pack(value, now)", HELPERS)
        self._run: list[tuple[str, str]] = []  # code for struct, expression
        self._parts: list[str] = []  # expressions: the bytes so far

    def function(self, layout: Layout) -> Any:
        self._message(layout, "value", "")
        self._line(f"return {self._joined()}")
        return self._source.function("pack", f"writer of {layout.name}")

    def _message(self, layout: Layout, value: str, place: str) -> None:
        fields = self._source.constant(frozenset(field.name for field in layout.fields))
        self._line(f"if type({value}) is not dict or not {value}.keys() <= {fields}:")
        self._line(f"    refuse_object({value}, f{place!r}, {layout.name!r}, {fields})")
        for field in layout.fields:
            inner_place = f"{place}.{field.name}" if place else field.name
            default = {} if isinstance(field.type, Layout) else DEFAULTS[field.type.kind]
            if layout.name == "std_msgs/Header" and field.name == "stamp":
                default = "now"  # rosbridge protocol 3.2.3
            if field.length is not None:
                default = [default] * max(0, field.length)
            inner = self._source.variable()
            self._line(f"{inner} = {value}.get({field.name!r}, {self._source.constant(default)})")
            if field.length is None:
                self._single(field.type, inner, inner_place)
            else:
                self._array(field.type, field.length, inner, inner_place)

    def _single(self, element: Scalar | Layout, value: str, place: str) -> None:
        if isinstance(element, Layout):
            return self._message(element, value, place)
        scalar = self._source.constant(element)
        refusal = f"    refuse_scalar({value}, f{place!r}, {scalar})"
        if element.kind in ("integer", "boolean"):
            right = "bool"
            if element.kind == "integer":
                low, high = element.limits
                right = f"int or not {low} <= {value} <= {high}"
            self._line(f"if type({value}) is not {right}:")
            self._line(refusal)
            self._run.append((element.code, value))
            return None
        result = self._source.variable()
        reading = {
            "number": f"{value} if type({value}) is float else number({value})",
            "string": f"utf8({value})",
            "time": f"seconds({value}, {scalar}, now)",
        }
        self._line(f"{result} = {reading[element.kind]}")
        # NaN is neither above nor below
        too_large = f" or {result} >= {FLOAT32_END} or {result} <= {-FLOAT32_END}" if element.name == "float32" else ""
        self._line(f"if {result} is None{too_large}:")
        self._line(refusal)
        if element.kind == "string":
            self._run.append(("I", f"len({result})"))
            self._part(result)
        else:
            self._run.append((element.code, result if element.kind == "number" else f"*{result}"))
        return None

    def _array(self, element: Scalar | Layout, length: int, value: str, place: str) -> None:
        if isinstance(element, Layout) or element.kind in ("string", "time"):
            return self._loop(element, length, value, place)
        scalar, result = self._source.constant(element), self._source.variable()
        self._line(f"{result} = array({value}, {scalar}, {length})")
        self._line(f"if {result} is None:")
        self._line(f"    refuse_array({value}, f{place!r}, {scalar}, {length})")
        if length == ANY_LENGTH:
            self._run.append(("I", f"len({result}) // {element.size}"))
        return self._part(result)

    def _loop(self, element: Scalar | Layout, length: int, value: str, place: str) -> None:
        wrong_length = "" if length == ANY_LENGTH else f" or len({value}) != {length}"
        self._line(f"if type({value}) is not list{wrong_length}:")
        self._line(f"    refuse_list({value}, f{place!r}, {length})")
        elements, index, item = self._source.variable(), self._source.variable(), self._source.variable()
        self._line(f"{elements} = []")
        self._line(f"for {index}, {item} in enumerate({value}):")
        outside = self._run, self._parts
        self._run, self._parts = [], []
        self._source.depth += 1
        self._single(element, item, f"{place}[{{{index}}}]")
        self._line(f"{elements}.append({self._joined()})")
        self._source.depth -= 1
        self._run, self._parts = outside
        if length == ANY_LENGTH:
            self._run.append(("I", f"len({elements})"))
        self._part(f"join({elements})")

    def _part(self, expression: str) -> None:
        """Bytes after the run so far."""
        if self._run:
            codes, values = "".join(code for code, _ in self._run), ", ".join(value for _, value in self._run)
            self._parts.append(f"{self._source.constant(struct.Struct(f'<{codes}').pack)}({values})")
            self._run.clear()
        if expression:
            self._parts.append(expression)

    def _joined(self) -> str:
        self._part("")
        return self._parts[0] if len(self._parts) == 1 else f"join(({' '.join(f'{part},' for part in self._parts)}))"

    def _line(self, text: str) -> None:
        self._source.line(text)


def packer(layout: Layout) -> Pack:
    """A function from a JSON object to the serialized message; ConversionError when the object does not fit.
    It is given the clock, too, for times that are "now" and the stamps of headers that have none."""
    pack: Pack = Writer().function(layout)
    return pack
