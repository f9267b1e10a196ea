"""What a device is told of a ROS parameter: rosserial_msgs/RequestParam, lists of int32, float32 and strings."""

import struct
from typing import Any

from robot.rosserial.frame import encode
from robot.rosserial.ids import PARAMETER

NOTHING = encode(PARAMETER, bytes(12))  # spares a sketch that waits its time-out


def answer(value: Any) -> bytes:
    """The frame for a value of the parameter server: a number, a truth (0 or 1), a string, or a list of one of these.

    ValueError for other values, and for numbers that do not fit.
    """
    values = value if isinstance(value, list) else [value]
    kinds = {int if isinstance(one, bool) else type(one) for one in values}
    try:
        if kinds == {int}:
            return encode(PARAMETER, _numbers("i", values) + bytes(8))
        if kinds == {float}:
            return encode(PARAMETER, bytes(4) + _numbers("f", values) + bytes(4))
        if kinds == {str}:
            texts = [text.encode() for text in values]
            strings = b"".join(struct.pack("<I", len(text)) + text for text in texts)
            return encode(PARAMETER, bytes(8) + struct.pack("<I", len(texts)) + strings)
    except (struct.error, OverflowError):
        raise ValueError(f"{value!r} does not fit in the device's 32 bits") from None
    raise ValueError(f"{value!r} is not a number, a string, or a list of either")


def _numbers(code: str, values: list[Any]) -> bytes:
    return struct.pack(f"<I{len(values)}{code}", len(values), *values)
