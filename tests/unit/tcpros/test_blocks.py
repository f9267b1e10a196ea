"""Messages out of a stream of bytes."""

import random

import pytest

from tcpros.blocks import MAX_LENGTH, BlockError, Blocks
from tcpros.header import LENGTH


def test_messages_come_out_whole_however_the_stream_is_cut() -> None:
    chance = random.Random(1)
    messages = [chance.randbytes(chance.choice([0, 1, 3, 4, 50, 3000])) for _ in range(300)]
    stream = b"".join(LENGTH.pack(len(message)) + message for message in messages)
    for longest in (1, 5, 100, 10_000, len(stream)):
        blocks, found, begin = Blocks(), [], 0
        while begin < len(stream):
            end = begin + chance.randint(1, longest)
            found += blocks.feed(stream[begin:end])
            begin = end
        assert found == messages


def test_it_says_how_much_is_missing_at_least() -> None:
    blocks = Blocks()
    assert blocks.missing == 4
    assert blocks.feed(LENGTH.pack(1000) + b"x" * 10) == []
    assert blocks.missing == 990
    assert blocks.feed(b"x" * 990 + b"\1") == [b"x" * 1000]
    assert blocks.missing == 3


def test_an_impossible_length_is_refused_at_once() -> None:
    with pytest.raises(BlockError, match=str(MAX_LENGTH + 1)):
        Blocks().feed(LENGTH.pack(MAX_LENGTH + 1))
