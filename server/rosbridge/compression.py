"""How operations travel to a client: as JSON, as text in a PNG image, or as CBOR (rosbridge protocol 3.1.2 to 3.1.4).

| compression | message on the WebSocket |
|---|---|
| none | text: JSON |
| png | text: {"op": "png", "data": base64 of a PNG whose pixels are the bytes of the JSON text} |
| cbor | binary: the operation in CBOR, blobs as byte strings, arrays of numbers as tagged byte strings |
| cbor-raw | binary: a publish in CBOR with "msg": {"secs", "nsecs", "bytes"}: the time, and the message as ROS has it |
"""

import base64
import math
import struct
import zlib
from io import BytesIO
from typing import Any

import cbor2

from server.messages.base64_text import decoded
from server.websocket.requests import RequestError, dumps

COMPRESSIONS = ("none", "png", "cbor", "cbor-raw")
# Of text in an image, and of an image: a small image may hold text without end.
MAX_TEXT = 8 * 2**20  # bytes
PNG_START = b"\x89PNG\r\n\x1a\n"
HEADER_END = 33  # of the chunk IHDR, which is the first
GREY, RGB = 0, 2  # PNG's colour types


def encode(operation: dict[str, Any] | str, compression: str) -> str | bytes:
    """The WebSocket message (text or binary) of an operation. For "none" and "png" it may be JSON text already; for
    "cbor" a message in it comes from MessageType.cbor, for "cbor-raw" from `raw`."""
    if compression in ("cbor", "cbor-raw"):
        return cbor2.dumps(operation)
    text = operation if isinstance(operation, str) else dumps(operation)
    return dumps({"op": "png", "data": to_png(text)}) if compression == "png" else text


def raw(data: bytes, secs: int, nsecs: int) -> dict[str, Any]:
    """The "msg" of cbor-raw; `secs`, `nsecs`: when the serialized message `data` was received."""
    return {"secs": secs, "nsecs": nsecs, "bytes": data}


def to_png(text: str) -> str:
    """Base64 of an RGB image, nearly square, whose pixels are the text, filled up with newlines: upstream's format."""
    from PIL import Image  # noqa: PLC0415  7 MB of memory, for the few clients that want it

    data = text.encode()
    pixels = max(1, math.ceil(len(data) / 3))
    width = math.isqrt(pixels)
    height = math.ceil(pixels / width)
    png = BytesIO()
    # nobody else is served meanwhile: fast rather than small
    Image.frombytes("RGB", (width, height), data.ljust(3 * width * height, b"\n")).save(png, "png", compress_level=1)
    return base64.b64encode(png.getvalue()).decode("ascii")


def from_png(data: str) -> str:
    """The JSON text in the data of an operation png; RequestError when there is none."""
    from PIL import Image  # noqa: PLC0415  as above

    try:
        with Image.open(BytesIO(essential(decoded(data))), formats=["PNG"]) as image:
            return str(image.tobytes(), "utf-8")
    # Pillow's PNG reader says SyntaxError, too
    except (OSError, ValueError, SyntaxError, struct.error, zlib.error) as error:
        raise RequestError(f"the data are no text in a PNG image: {str(error)[:100]}") from None


def essential(png: bytes) -> bytes:
    """The image without all that its pixels do not need: Pillow would unpack texts and colour profiles, too.
    RequestError for one that is too large or has another format than `to_png` makes; ValueError for no image."""
    if png[: len(PNG_START)] != PNG_START or len(png) < HEADER_END:
        raise ValueError("no PNG")
    width, height, depth, colour = struct.unpack_from(">IIBB", png, len(PNG_START) + 8)
    if (depth, colour) not in ((8, GREY), (8, RGB)):
        raise RequestError("text is in images of 8 bits per colour, RGB or grey")
    if width * height * 3 > MAX_TEXT:
        raise RequestError(f"an image of {width} x {height} pixels is too large for {MAX_TEXT} bytes of text")
    kept, at = [png[:HEADER_END]], HEADER_END
    while at + 8 <= len(png):
        size, kind = struct.unpack_from(">I4s", png, at)
        end = at + 12 + size  # length, type, data, check sum
        if kind in (b"IDAT", b"IEND"):
            kept.append(png[at:end])
        at = end
    return b"".join(kept)
