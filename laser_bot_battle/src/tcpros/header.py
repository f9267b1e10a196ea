"""The header with which every TCPROS connection begins (wiki.ros.org/ROS/Connection Header).

uint32 length of what follows, then per field: uint32 length, `name=value` in UTF-8; all little endian.
"""

import struct
from collections.abc import Mapping

MAX_LENGTH = 2**20  # bytes

LENGTH = struct.Struct("<I")


class HeaderError(ValueError):
    """The peer does not speak TCPROS."""


def encode(fields: Mapping[str, str]) -> bytes:
    """The header with its length in front."""
    lines = [f"{name}={value}".encode() for name, value in fields.items()]
    block = b"".join(LENGTH.pack(len(line)) + line for line in lines)
    return LENGTH.pack(len(block)) + block


def decode(block: bytes) -> dict[str, str]:
    """The fields of a header without its length. HeaderError when it is none."""
    fields = {}
    begin = 0
    while begin < len(block):
        if begin + 4 > len(block):
            raise HeaderError("the header ends within a field")
        (length,) = LENGTH.unpack_from(block, begin)
        begin += 4 + length
        if begin > len(block):
            raise HeaderError("the header ends within a field")
        try:
            name, separator, value = block[begin - length : begin].decode().partition("=")
        except UnicodeDecodeError:
            raise HeaderError("a field of the header is not UTF-8") from None
        if not separator:
            raise HeaderError("a field of the header has no =")
        fields[name.strip()] = value
    return fields
