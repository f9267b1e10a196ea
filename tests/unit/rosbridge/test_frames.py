"""Bytes of a WebSocket client become messages, or the reason for its end."""

import random
import tracemalloc

import pytest
from websockets.client import ClientProtocol
from websockets.frames import Close
from websockets.protocol import State
from websockets.uri import parse_uri

from server.websocket.frames import (
    MAX_PARTS,
    FrameError,
    Frames,
    Message,
    Ping,
    Pong,
    close_frame,
    frame,
    ping_frame,
    pong_frame,
)

# RFC 6455 5.7: a masked text, a masked pong
HELLO = bytes.fromhex("81 85 37 fa 21 3d 7f 9f 4d 51 58")
PONG = bytes.fromhex("8a 85 37 fa 21 3d 7f 9f 4d 51 58")
KILO = 1000


def masked(head: int, payload: bytes = b"", length: int | None = None) -> bytes:
    """A client's frame with a mask of zeros; another `length` than the payload's is a lie."""
    size = len(payload) if length is None else length
    if size < 126:
        start = bytes((head, 0x80 | size))
    elif size < 2**16:
        start = bytes((head, 0x80 | 126)) + size.to_bytes(2, "big")
    else:
        start = bytes((head, 0x80 | 127)) + size.to_bytes(8, "big")
    return start + bytes(4) + payload


def messages(data: bytes, max_message: int = KILO) -> list[Message]:
    frames = Frames(max_message)
    frames.feed(data)
    return taken(frames)


def taken(frames: Frames) -> list[Message]:
    found = []
    while (message := frames.take()) is not None:
        found.append(message)
    return found


def error(data: bytes, max_message: int = KILO) -> int:
    """The code with which a client that sends this is closed."""
    with pytest.raises(FrameError) as raised:
        messages(data, max_message)
    return raised.value.code


def test_the_rfcs_own_examples() -> None:
    assert messages(HELLO + PONG) == ["Hello", Pong(b"Hello")]
    assert frame("Hello") == bytes.fromhex("81 05 48 65 6c 6c 6f")
    assert frame(bytes(256))[:4] == bytes.fromhex("82 7e 01 00")
    assert frame(bytes(65536))[:10] == bytes.fromhex("82 7f 00 00 00 00 00 01 00 00")
    assert (ping_frame(), pong_frame(b"Hello")) == (b"\x89\x00", bytes.fromhex("8a 05 48 65 6c 6c 6f"))


def test_parts_make_one_message_with_control_frames_between_them() -> None:
    data = masked(0x01, "Grü".encode()[:3]) + masked(0x89, b"?") + masked(0x00, b"") + masked(0x80, "ü".encode()[1:])
    assert messages(data) == [Ping(b"?"), "Grü"]
    assert messages(masked(0x02, b"a") + masked(0x80, b"b") + HELLO) == [b"ab", "Hello"]


def test_the_end_has_a_code_and_a_reason() -> None:
    assert messages(masked(0x88)) == [Close(1005, "")]
    assert messages(masked(0x88, b"\x03\xe9bye")) == [Close(1001, "bye")]
    assert close_frame(1009, "ä" * 100) == b"\x88\x7c\x03\xf1" + ("ä" * 61).encode()


WRONG = {
    "not masked": (b"\x81\x05Hello", 1002),
    "reserved bit": (masked(0xC1, b"a"), 1002),
    "unknown data": (masked(0x83), 1002),
    "unknown control": (masked(0x8B), 1002),
    "long control": (masked(0x89, bytes(126)), 1002),
    "control in parts": (masked(0x09), 1002),
    "continues nothing": (masked(0x80, b"a"), 1002),
    "text within a message": (masked(0x01, b"a") + HELLO, 1002),
    "binary within a message": (masked(0x02, b"a") + masked(0x02, b"b"), 1002),
    "no UTF-8": (masked(0x81, b"\xff"), 1007),
    "surrogates": (masked(0x81, b"\xed\xa0\x80"), 1007),
    "no UTF-8 in parts": (masked(0x01, b"\xc3") + masked(0x80, b"a"), 1007),
    "no UTF-8 at the end": (masked(0x88, b"\x03\xe8\xff"), 1007),
    "half a code": (masked(0x88, b"\x03"), 1002),
    "a code for nobody": (masked(0x88, b"\x03\xed"), 1002),
}


@pytest.mark.parametrize(("data", "code"), WRONG.values(), ids=WRONG)
def test_what_breaks_the_protocol_ends_it(data: bytes, code: int) -> None:
    assert error(data) == code


@pytest.mark.parametrize("length", [KILO + 1, 2**16, 2**63, 2**64 - 1])
@pytest.mark.parametrize("kind", [0x81, 0x01, 0x82])
def test_what_is_too_long_is_refused_before_it_comes(kind: int, length: int) -> None:
    assert error(masked(kind, b"", length)) == 1009


def test_parts_are_bounded_together() -> None:
    half = masked(0x01, bytes(600))
    assert error(half + masked(0x80, b"", 401)) == 1009
    assert len(str(messages(half + masked(0x80, bytes(400)))[0])) == KILO


@pytest.mark.parametrize("part", [b"", b"x"])
def test_the_number_of_parts_is_bounded(part: bytes) -> None:
    assert error(masked(0x01, part) + masked(0x00, part) * MAX_PARTS, 10**6) == 1008
    complete = masked(0x01, part) + masked(0x00, part) * (MAX_PARTS - 2) + masked(0x80, part)
    assert messages(complete * 2, 10**6) == [(part * MAX_PARTS).decode()] * 2


def test_the_limit_may_be_changed() -> None:
    frames = Frames(3)
    frames.max_message = 5
    frames.feed(HELLO)
    assert taken(frames) == ["Hello"]
    frames.max_message = 3
    frames.feed(HELLO)
    with pytest.raises(FrameError):
        frames.take()


def test_pieces_of_any_size_give_the_same_messages() -> None:
    """As the websockets library frames them, with random masks."""
    dice = random.Random(5)
    client = ClientProtocol(parse_uri("ws://localhost/"), state=State.OPEN)
    expected: list[Message] = []
    for _ in range(200):
        data = dice.choice(["text ", "ä€𝄞", "{}"]) * dice.choice([0, 1, 15, 21, 22, 3000, 20_000])
        if dice.random() < 0.3:
            client.send_binary(data.encode())
            expected.append(data.encode())
        elif dice.random() < 0.3:
            raw = data.encode()
            cut = dice.randint(0, len(raw))
            client.send_text(raw[:cut], fin=False)
            client.send_ping(b"between")
            client.send_continuation(raw[cut:], fin=True)
            expected += [Ping(b"between"), data]
        else:
            client.send_text(data.encode())
            expected.append(data)
    stream = b"".join(client.data_to_send())
    frames, found, at = Frames(10**6), [], 0
    while at < len(stream):
        size = dice.choice([1, 2, 5, 100, 16384])
        frames.feed(stream[at : at + size])
        at += size
        if dice.random() < 0.9:
            found += taken(frames)
    assert found + taken(frames) == expected
    assert frames.pending == 0


def test_a_long_message_in_pieces_needs_little_more_memory_than_itself() -> None:
    size = 2**23
    data, frames = masked(0x82, bytes(size)), Frames(size)
    tracemalloc.start()
    try:
        for at in range(0, len(data) - 16384, 16384):
            frames.feed(memoryview(data)[at : at + 16384])
            assert frames.take() is None
        assert tracemalloc.get_traced_memory()[1] < 1.5 * size
        frames.feed(data[-(len(data) % 16384 or 16384) :])
        assert frames.take() == bytes(size)
        assert frames.take() is None
        assert tracemalloc.get_traced_memory()[0] < 0.1 * size
    finally:
        tracemalloc.stop()
