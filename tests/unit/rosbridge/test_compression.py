"""Operations as PNG and CBOR."""

import base64
import json
import struct
import zlib
from io import BytesIO
from typing import Any

import cbor2
import pytest
from PIL import Image

from server.messages.base64_text import decoded
from server.rosbridge.compression import PNG_START, encode, from_png, raw, to_png
from server.websocket.requests import RequestError

OPERATION = {"op": "publish", "topic": "/chat", "msg": {"data": "häßlich \U0001f916"}}


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width: int, height: int, *chunks: bytes, depth: int = 8, colour: int = 2) -> str:
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))
    return base64.b64encode(b"".join([PNG_START, header, *chunks, chunk(b"IEND", b"")])).decode()


def test_no_compression_is_json() -> None:
    assert json.loads(encode(OPERATION, "none")) == OPERATION
    assert encode('{"op":"x"}', "none") == '{"op":"x"}'


@pytest.mark.parametrize("operation", [OPERATION, json.dumps(OPERATION), {"op": "x" * 10_000}, {}])
def test_png_has_the_json_in_its_pixels(operation: Any) -> None:
    message = json.loads(encode(operation, "png"))
    assert message["op"] == "png"
    with Image.open(BytesIO(base64.b64decode(message["data"]))) as image:
        assert (image.format, image.mode) == ("PNG", "RGB")
        assert abs(image.width - image.height) <= 2
        text = image.tobytes().decode()
    assert text.strip("\n") == encode(operation, "none")
    assert from_png(message["data"]) == text


def test_text_of_other_encoders_is_read(operation: str = '{"op":"x"}') -> None:
    # upstream's first format: grey, a line of the text's length
    grey = BytesIO()
    Image.frombytes("L", (len(operation), 1), operation.encode()).save(grey, "png")
    assert from_png(base64.b64encode(grey.getvalue()).decode()) == operation


@pytest.mark.parametrize(
    "data",
    [
        "no base64!",
        "",
        base64.b64encode(b"no png" * 10).decode(),
        base64.b64encode(PNG_START).decode(),
        to_png("x" * 100)[:40],
        png(1, 1),
        png(1, 1, chunk(b"IDAT", b"no zlib")),
        png(4, 4, chunk(b"IDAT", zlib.compress(b"\0\0"))),
        png(1, 1, chunk(b"IDAT", zlib.compress(b"\0\xff\xff\xff"))),
        png(0, 0, chunk(b"IDAT", zlib.compress(b""))),
    ],
)
def test_an_image_without_text_is_refused(data: str) -> None:
    with pytest.raises(RequestError, match="no text in a PNG image"):
        from_png(data)


@pytest.mark.parametrize(
    ("width", "height", "colour", "depth", "reason"),
    [(20_000, 20_000, 2, 8, "too large"), (2**32 - 1, 2**32 - 1, 0, 8, "too large"), (1, 1, 6, 8, "RGB or grey"),
     (1, 1, 2, 16, "RGB or grey")],
)  # fmt: skip
def test_an_image_that_would_fill_the_memory_is_not_unpacked(
    width: int, height: int, colour: int, depth: int, reason: str
) -> None:
    with pytest.raises(RequestError, match=reason):
        from_png(png(width, height, chunk(b"IDAT", zlib.compress(bytes(1000))), colour=colour, depth=depth))


def test_what_an_image_has_beside_its_pixels_is_not_unpacked() -> None:
    bomb = chunk(b"zTXt", b"bomb\0\0" + zlib.compress(bytes(4 * 2**20)))
    pixels = chunk(b"IDAT", zlib.compress(b"\0{}\n"))
    larger = chunk(b"IHDR", struct.pack(">IIBBBBB", 20_000, 20_000, 8, 2, 0, 0, 0))
    assert from_png(png(1, 1, bomb, larger, pixels)) == "{}\n"


def test_cbor_is_the_operation() -> None:
    operation = {**OPERATION, "msg": {"data": b"\0\1", "numbers": cbor2.CBORTag(85, struct.pack("<f", 0.5))}}
    message = encode(operation, "cbor")
    assert isinstance(message, bytes)
    assert cbor2.loads(message) == operation


def test_cbor_raw_has_the_message_as_ros_has_it_and_the_time() -> None:
    message = encode({"op": "publish", "topic": "/chat", "msg": raw(b"\1\0\0\0a", 5, 6)}, "cbor-raw")
    assert isinstance(message, bytes)
    assert cbor2.loads(message) == {
        "op": "publish",
        "topic": "/chat",
        "msg": {"secs": 5, "nsecs": 6, "bytes": b"\1\0\0\0a"},
    }


@pytest.mark.parametrize("end", ["\n", "\r\n", " ", "\t"])
def test_base64_may_come_in_lines(end: str) -> None:
    """As Android's and Java's encoders for MIME write it."""
    data = bytes(range(256))
    text = base64.b64encode(data).decode()
    lines = end.join(text[start : start + 76] for start in range(0, len(text), 76)) + end
    assert decoded(lines) == decoded(text) == data
    png = to_png('{"op":"x"}')
    assert from_png(end.join(png[start : start + 76] for start in range(0, len(png), 76))).strip() == '{"op":"x"}'
