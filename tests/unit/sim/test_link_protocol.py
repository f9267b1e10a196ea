"""Lines between the robots' hardware and the arena."""

import pytest

from sim.arena import protocol
from sim.arena.protocol import Beam, CarrierEdge, LinkError, Wheels, parse_event, parse_hello


@pytest.mark.parametrize("name", ["virtual0", "A_b-9", "x" * 32])
def test_a_hello_names_the_robot(name: str) -> None:
    assert parse_hello(f"robot {name}".encode()) == name


@pytest.mark.parametrize(
    "line", [b"", b"robot", b"robot ", b"robot a b", b"robot \xff", b"robot " + b"x" * 33, b"wheels 0 0"]
)
def test_another_first_line_is_an_error(line: bytes) -> None:
    with pytest.raises(LinkError, match="robot <name>"):
        parse_hello(line)


def test_events_are_understood() -> None:
    assert parse_event(b"wheels -320 4096") == Wheels(-320, 4096)
    assert parse_event(b"beam 1") == Beam(True)
    assert parse_event(b"beam 0") == Beam(False)
    assert parse_event(b"carrier 1 16000000") == CarrierEdge(True, 16_000_000)
    assert parse_event(b"carrier 0 0") == CarrierEdge(False, 0)


@pytest.mark.parametrize(
    "line",
    [b"", b"beam", b"beam 2", b"wheels 1", b"wheels 1 2 3", b"wheels 1.5 2", b"wheels " + b"9" * 16 + b" 0",
     b"wheels 1  2", b" beam 1", b"light 1", b"\x00\xff", b"carrier 1",
     b"carrier 2 5", b"carrier 1 -5", b"carrier 1 " + b"9" * 19, "wheels ١ 2".encode()],
)  # fmt: skip
def test_anything_else_is_an_error(line: bytes) -> None:
    with pytest.raises(LinkError, match="expected"):
        parse_event(line)


def test_lines_to_the_robot() -> None:
    assert (protocol.light(True), protocol.light(False)) == (b"light 1\n", b"light 0\n")
    assert protocol.lamp() == b"lamp 1\n"
    assert protocol.carrier(7, True, 16_000_000) == b"carrier 7 1 16000000\n"
    assert protocol.error("why") == b"error why\n"
