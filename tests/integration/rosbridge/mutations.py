"""What a fuzz test sends to rosbridge: operations of every kind, damaged in many ways.

Each is made of a seed, a role and a number alone, so that the one that has done harm can be made again.
"""

import base64
import copy
import json
import math
import re
import struct
import zlib
from collections.abc import Sequence
from random import Random
from typing import Any, NamedTuple

from tests.integration.rosbridge.ends import COMMAND_TYPE
from tests.integration.rosbridge.operations import Json, Role, operation
from tests.support.bare import BINARY, CLOSE, CONTINUATION, PING, PONG, TEXT, frame

ODD: Sequence[Any] = (
    *(None, True, False, [], {}, [[]], [{}], [None], {"": ""}, {"data": 1}, {"secs": 2**32, "nsecs": -(2**31)}),
    *(0, 1, -1, 2, 127, 128, -128, -129, 255, 256, 2**31 - 1, 2**31, -(2**31), 2**32, 2**63, 2**64, -(2**63) - 1),
    *(0.0, -0.0, 1.0, 0.5, -1.5, 1e9, 1e9 + 1, 3.5e38, -3.5e38, 1.7e308, 5e-324, math.nan, math.inf, -math.inf),
    *("", " ", "x", "\0", "a\nb\r\n", "\x1b[31m", "\x7f", "\ud800", "\udc00\ud800", "\ud83d", "\U0001f600", "é\u2028"),
    *("/", "//", "~", "~/", "/a//b", "..", "*", "/" * 300, "{}", "%s%n", "a" * 256, "a" * 257, "٣", "1", "-1", "null"),
    *("now", "NaN", "Infinity", "AAAA", "AAA", "!", "none", "png", "cbor", "cbor-raw", "error", "info", "operator"),
    *("std_msgs/String", "std_msgs/Nothing", "os/path", "a/b", "std_msgs/../x", COMMAND_TYPE, "__class__", "op"),
)
# JSON as no library writes it.
RAW = (
    *("NaN", "-Infinity", "1e999", "-0", "01", "0x1", "1.", ".5", "+1", "'x'", "", "tru", "nul", '"', '"\\', "\0"),
    *('"\\ud800"', '"\\u0000"', '"\\x"', '"\t"', '"\x7f"', "{", "}", "[", "]", ",", ":", "\ufeff", "//", "9" * 4300),
)
TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|-?\d[\d.eE+-]*|true|false|null')
FRAMES = (866, 70, 30, 20, 1, 10, 1, 2)  # how often: see _framed
WRAPPERS = {"fragment", "png"}


class Mutation(NamedTuple):
    said: bytes
    """what is in the frames"""
    data: bytes
    """the frames, for the socket"""
    whole: bool
    """they end where a frame ends"""


def mutation(seed: int, role: Role, number: int, call: str) -> Mutation:
    """`call`: the id of a call that the server waits for, if there is one."""
    random = Random(f"{seed} {role.name} {number}")
    text = _text(random, role, call)
    texts = _fragments(random, text) if random.random() < 0.05 else [text]
    payloads = [text.encode("utf-8", "surrogatepass") for text in texts]
    if random.random() < 0.03:
        payloads = [_flipped(random, payload) for payload in payloads]
    pieces = [_framed(random, payload) for payload in payloads]
    data = b"".join(data for data, _ in pieces)
    return Mutation(b" ".join(payloads), data, all(whole for _, whole in pieces))


# ---- what is done to them ----


def _text(random: Random, role: Role, call: str) -> str:
    chance = random.random()
    if chance < 0.14:
        made = (_fragment if chance < 0.07 else _png)(random, role, call)
    else:
        made = json.loads(json.dumps(operation(random, role, call)))  # the templates stay as they are
    for _ in range(random.choice((0, 0, 0, 1, 1, 2))):
        random.choice((_drop, _retype, _retype, _add))(random, made)
    ascii_only = random.random() < 0.97
    text = json.dumps(made, ensure_ascii=ascii_only)
    for _ in range(random.choice((0, 0, 0, 0, 0, 0, 1, 2))):
        text = random.choice((_double, _exchange, _exchange, _cut, _insert))(random, text)
    return text


def _place(random: Random, operation: Json) -> tuple[Any, Any]:
    """An object or list in it, and a key or index; seldom that of the operation's kind, without which nothing else
    matters."""
    holder: Any = operation
    while True:
        keys = [*holder] if isinstance(holder, dict) else range(len(holder))
        key = random.choice(keys)
        if key == "op" and random.random() < 0.8:
            key = random.choice(keys)
        if not holder[key] or not isinstance(holder[key], dict | list) or random.random() < 0.3:
            return holder, key
        holder = holder[key]


def _drop(random: Random, operation: Json) -> None:
    if operation:
        holder, key = _place(random, operation)
        del holder[key]


def _retype(random: Random, operation: Json) -> None:
    if operation:
        holder, key = _place(random, operation)
        holder[key] = _odd(random)


def _add(random: Random, operation: Json) -> None:
    names = ("id", "type", "latch", "msg", "args", "compression", "fragment_size", "timeout", "\ud800", "x" * 99)
    operation[random.choice(names)] = _odd(random)


def _odd(random: Random) -> Any:
    if random.random() < 0.95:
        return copy.deepcopy(random.choice(ODD))  # which may be damaged further
    many = random.choice((100, 1000, 10_000)) if random.random() < 0.9 else 70_000
    long: tuple[Any, ...] = (
        "x" * many,
        "\U0001f600" * (many // 4),
        [0] * many,
        [{}] * (many // 4),
        10 ** min(many, 4299),
    )
    return random.choice(long)


def _double(random: Random, text: str) -> str:
    """A key comes twice."""
    key = random.choice(("op", "topic", "type", "msg", "id", "service", "data"))
    field = f"{json.dumps(key)}:{json.dumps(_odd(random))}"
    return f"{{{field},{text[1:]}" if random.random() < 0.5 else f"{text[:-1]},{field}}}"


def _exchange(random: Random, text: str) -> str:
    """A value or key becomes something that is no JSON, or too large, or too deep."""
    tokens = list(TOKEN.finditer(text))
    if not tokens:
        return text
    depth = random.choice((5, 100, 900, 1000, 5000))
    deep = ("[" * depth + "]" * depth, '{"a":' * depth + "1" + "}" * depth, "[" * depth)
    token = random.choice(tokens)
    return text[: token.start()] + random.choice(RAW if random.random() < 0.8 else deep) + text[token.end() :]


def _cut(random: Random, text: str) -> str:
    start = random.randrange(len(text) + 1)
    return text[:start] + (text[start + random.randint(1, 9) :] if random.random() < 0.5 else "")


def _insert(random: Random, text: str) -> str:
    start = random.randrange(len(text) + 1)
    return text[:start] + random.choice((*RAW, text)) + text[start:]


def _flipped(random: Random, data: bytes) -> bytes:
    """Some bits are others."""
    flipped = bytearray(data)
    for _ in range(random.randint(1, 3) if data else 0):
        flipped[random.randrange(len(data))] ^= 1 << random.randrange(8)
    return bytes(flipped)


def _part(text: str, number: int, total: int, name: str) -> Json:
    part = text[len(text) * number // total : len(text) * (number + 1) // total]
    return {"op": "fragment", "id": name, "data": part, "num": number, "total": total}


def _fragments(random: Random, text: str) -> list[str]:
    """The text in parts, perhaps out of order, some missing, some twice."""
    total, name = random.randint(1, 12), f"g{random.randrange(9)}"
    parts = [json.dumps(_part(text, number, total, name)) for number in range(total)]
    if random.random() < 0.5:
        random.shuffle(parts)
    if random.random() < 0.2:
        parts.insert(0, random.choice(parts))
    if random.random() < 0.2:
        parts.pop()
    return parts


def _image(random: Random, pixels: bytes) -> bytes:
    """A PNG, of which the size or the format may be a lie."""
    grey = random.random() < 0.3
    width = max(1, len(pixels) if grey else math.ceil(len(pixels) / 3))
    height, depth, colour = 1, 8, 0 if grey else 2
    if random.random() < 0.2:
        width, height = random.choice(((0, 0), (2**31, 1), (1, 2**31 - 1), (1600, 1600), (width + 1, height), (1, 1)))
    if random.random() < 0.1:
        depth, colour = random.choice((1, 8, 16)), random.choice((0, 2, 3, 4, 6, 7))
    rows = zlib.compress(b"\0" + pixels.ljust(width if grey else 3 * width, b"\n") if width < 2**20 else pixels, 1)
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)),
        (b"IDAT", rows),
        (b"IEND", b""),
    ]
    if random.random() < 0.2:
        chunks.insert(random.randrange(4), random.choice(((b"tEXt", b"a\0b"), (b"zTXt", rows), chunks[1], chunks[0])))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    )


def _framed(random: Random, payload: bytes) -> tuple[bytes, bool]:
    """The bytes, and whether they are whole frames. Few break WebSocket's rules, for that ends the connection."""
    data = frame(payload)
    match random.choices(("right", "parts", "often", "binary", "cut", "control", "close", "broken"), FRAMES)[0]:
        case "parts":
            data = _parts(random, payload)
        case "often" if len(data) < 2000:
            data *= random.choice((2, 3, 50))
        case "binary":
            data = frame(payload, BINARY)
        case "cut":
            return data[: random.randrange(len(data))], False
        case "control":
            data = frame(b"", random.choice((PING, PONG))) * random.choice((1, 100))
        case "close":
            code = struct.pack("!H", random.choice((0, 999, 1000, 1001, 1005, 1006, 1015, 3000, 5000, 65535)))
            data = frame(random.choice((b"", b"\3", code, code + payload[:100], code + b"\n\xff")), CLOSE)
        case "broken":
            return _broken(random, data[:2000]), False
    return data, True


def _broken(random: Random, data: bytes) -> bytes:
    """An unknown kind, a reserved bit, no mask, or a length that is not true."""
    if random.random() < 0.5:
        return bytes((data[0] ^ 1 << random.randrange(8), data[1] ^ random.choice((0, 0, 1, 4, 128)))) + data[2:]
    return struct.pack("!BBQ", 0x81, 0xFF, random.choice((2**16, 2**23 + 1, 2**32, 2**63, 2**64 - 1))) + data[6:]


def _parts(random: Random, payload: bytes) -> bytes:
    """A message in frames, with control frames between them; now and then too many, or not all."""
    count = random.choice((1, 2, 3, 10)) if random.random() < 0.98 else 1001
    size = len(payload) // count + 1
    pieces = [payload[number * size : (number + 1) * size] for number in range(count)]
    frames = [
        frame(piece, CONTINUATION if number else TEXT, fin=number == count - 1) for number, piece in enumerate(pieces)
    ]
    if random.random() < 0.3:
        frames.insert(random.randrange(count), frame(b"hello", PING))
    if random.random() < 0.1:
        frames.pop()
    return b"".join(frames)


def _fragment(random: Random, role: Role, call: str) -> Json:
    """Some part of something."""
    total = random.randint(1, 4)
    return _part(_text(random, role, call), random.randrange(total), total, f"f{random.randrange(9)}")


def _png(random: Random, role: Role, call: str) -> Json:
    data = _image(random, _text(random, role, call).encode("utf-8", "surrogatepass"))
    if random.random() < 0.3:
        data = _flipped(random, data)
    if random.random() < 0.1:
        data = data[: random.randrange(len(data))]
    return {"op": "png", "data": base64.b64encode(data).decode()}
