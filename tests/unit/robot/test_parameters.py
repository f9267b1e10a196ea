import struct

import pytest

from robot.rosserial.parameters import answer


def lists(ints: bytes, floats: bytes, strings: bytes) -> bytes:
    """The payload of the frame."""
    return ints + floats + strings


NONE = bytes(4)


@pytest.mark.parametrize(
    ("value", "payload"),
    [
        (7, lists(struct.pack("<Ii", 1, 7), NONE, NONE)),
        ([1, -2], lists(struct.pack("<Iii", 2, 1, -2), NONE, NONE)),
        ([True, 3], lists(struct.pack("<Iii", 2, 1, 3), NONE, NONE)),
        (0.5, lists(NONE, struct.pack("<If", 1, 0.5), NONE)),
        ("grün", lists(NONE, NONE, struct.pack("<II", 1, 5) + "grün".encode())),
        (["a", ""], lists(NONE, NONE, struct.pack("<II", 2, 1) + b"a" + NONE)),
    ],
)
def test_values_are_the_lists_of_request_param(value: object, payload: bytes) -> None:
    assert answer(value)[7:-1] == payload


@pytest.mark.parametrize("value", [{"p": 1}, [], [1, "a"], [1, 0.5], [[1]], None, 2**31, [1, -(2**40)], 1e300])
def test_other_values_are_refused(value: object) -> None:
    with pytest.raises(ValueError, match=r"does not fit|is not a number"):
        answer(value)
