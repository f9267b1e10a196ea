"""Messages in pieces."""

import json
import random
from typing import Any

import pytest

from server.rosbridge.fragments import MAX_FRAGMENTS, PATIENCE, Reassembly, split
from server.websocket.requests import Request, RequestError

TEXT = json.dumps({"op": "publish", "msg": {"data": 'häß"\\ \U0001f916' * 50}}, ensure_ascii=False)


def fragment(**fields: Any) -> Request:
    return Request({"op": "fragment", "id": "a", "data": "x", "num": 0, "total": 2, **fields})


def add(reassembly: Reassembly, now: float = 0.0, **fields: Any) -> str | None:
    return reassembly.add(fragment(**fields), now)


def test_a_short_message_stays_whole() -> None:
    assert split(TEXT, len(TEXT), 1) == [TEXT]


@pytest.mark.parametrize("fragment_size", [100, len(TEXT) - 1, 1, 0, -5])
def test_the_pieces_make_the_message_in_any_order(fragment_size: int) -> None:
    pieces = [json.loads(piece) for piece in split(TEXT, fragment_size, 7)]
    assert [(piece["op"], piece["id"], piece["num"]) for piece in pieces] == [
        ("fragment", 7, num) for num in range(len(pieces))
    ]
    assert {piece["total"] for piece in pieces} == {len(pieces)} != {1}
    assert "".join(piece["data"] for piece in pieces) == TEXT
    if fragment_size >= 100:
        assert max(len(piece["data"]) for piece in pieces) == fragment_size
    random.Random(2).shuffle(pieces)
    reassembly = Reassembly()
    *unfinished, whole = [reassembly.add(Request(piece), 0.0) for piece in pieces]
    assert (whole, set(unfinished)) == (TEXT, {None})


def test_the_number_of_pieces_is_bounded() -> None:
    assert len(split("x" * 2**20, 1, "a")) <= MAX_FRAGMENTS


def test_a_piece_may_come_twice() -> None:
    reassembly = Reassembly()
    assert add(reassembly, num=1, data="y") is None
    assert add(reassembly, num=1, data="z") is None
    assert add(reassembly, num=0, data="x") == "xy"


def test_messages_may_be_mixed_and_ids_used_again() -> None:
    reassembly = Reassembly()
    for _ in range(20):
        assert add(reassembly, id="a", num=0, data="a") is None
        assert add(reassembly, id=1, num=0, data="b") is None
        assert add(reassembly, id="a", num=1, data="c") == "ac"
        assert add(reassembly, id=1, num=1, data="d") == "bd"


def test_a_cut_through_a_character_of_javascript_is_mended() -> None:
    reassembly = Reassembly()
    add(reassembly, num=0, data='"ä\ud83e')
    assert add(reassembly, num=1, data='\udd16"') == '"ä\U0001f916"'


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"id": None}, "needs the id"),
        ({"id": [1]}, "needs the id"),
        ({"num": -1}, "'num' must be a whole number"),
        ({"num": True}, "'num' must be a whole number"),
        ({"num": None}, "num is below its total"),
        ({"num": 2}, "num is below its total"),
        ({"total": 0}, "num is below its total"),
        ({"total": None}, "num is below its total"),
        ({"total": MAX_FRAGMENTS + 1}, "the total is 10000 at most"),
        ({"total": 1e3}, "'total' must be a whole number"),
        ({"data": None}, "'data' must be a string"),
        ({"data": {}}, "'data' must be a string"),
        ({"total": 3}, "the message has 2 fragments, not 3"),
    ],
)
def test_nonsense_is_refused_and_changes_nothing(fields: dict[str, Any], reason: str) -> None:
    reassembly = Reassembly()
    add(reassembly, num=1, data="y")
    with pytest.raises(RequestError, match=reason):
        add(reassembly, **fields)
    assert add(reassembly, num=0) == "xy"


def test_unfinished_messages_are_bounded_in_number() -> None:
    reassembly = Reassembly()
    for number in range(8):
        add(reassembly, id=number)
    with pytest.raises(RequestError, match="8 unfinished messages"):
        add(reassembly, id="one more")
    assert add(reassembly, id=3, num=1) == "xx"
    assert add(reassembly, id="one more") is None


def test_unfinished_messages_are_bounded_in_size() -> None:
    reassembly = Reassembly(max_size=10_000)
    add(reassembly, id="small")
    for num in range(4):
        add(reassembly, id="large", data="x" * 2_000, num=num, total=100)
    with pytest.raises(RequestError, match="more than 10000 bytes; this one is dropped"):
        add(reassembly, id="large", data="x" * 2_000, num=4, total=100)
    assert add(reassembly, id="small", num=1) == "xx"
    # its memory is free again
    add(reassembly, id="other", data="x" * 9_000)
    # characters that take four bytes, and empty pieces, count for what they take
    with pytest.raises(RequestError, match="dropped"):
        add(Reassembly(max_size=10_000), data="\U0001f916" * 2_500)
    empty = Reassembly(max_size=10_000)
    with pytest.raises(RequestError, match="dropped"):
        for num in range(1_000):
            add(empty, data="", num=num, total=1_001)


def test_a_message_whose_pieces_stop_coming_is_forgotten() -> None:
    reassembly = Reassembly()
    add(reassembly, 0.0, total=3)
    add(reassembly, PATIENCE - 1, num=1, total=3)
    assert add(reassembly, 2 * PATIENCE - 1.5, num=2, total=3) == "xxx"
    add(reassembly, 50.0)
    assert add(reassembly, 50.0 + PATIENCE, num=1) is None
    assert add(reassembly, 50.0 + PATIENCE, num=0) == "xx"
