"""Robots' hardware on real sockets: light that comes and goes, places kept, strangers turned away."""

import math
import statistics
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress

import pytest

from sim.arena.link import MAX_STRANGERS
from tests.integration.sim.arena import Arena, Hardware
from tests.support.polling import until


def two_face_to_face(stack: ExitStack, arena: Arena) -> tuple[Hardware, Hardware]:
    """Robots a and b along the bottom wall, 0.5 m apart, looking at each other; each has heard `light 0`."""
    a = stack.enter_context(Hardware(arena, "a0"))
    assert a.line() == "light 0"
    b = stack.enter_context(Hardware(arena, "b1"))
    assert b.line() == "light 0"
    a.drive_to(0.5, 0.15)
    b.drive_to(1.43, 0.15)
    b.drive_to(1.0, 0.15)
    a.face(0.0)
    b.face(math.pi)
    return a, b


def test_a_beam_is_light_for_the_robot_in_front(arena: Arena) -> None:
    with ExitStack() as stack:
        shooter, target = two_face_to_face(stack, arena)
        shooter.send("beam 1")
        assert target.line() == "light 1"
        assert arena.look()["b1"]["lit"] and arena.look()["a0"]["beam"]
        shooter.send("beam 0")
        assert target.line() == "light 0"
        assert arena.look()["b1"]["hits"] == 1
        assert arena.look()["a0"]["hits"] == 0


def test_edges_of_a_carrier_go_to_the_robot_in_front_and_a_whole_packet_is_a_hit(arena: Arena) -> None:
    with ExitStack() as stack:
        shooter, target = two_face_to_face(stack, arena)
        edges = [(on, 10**9 + 28_800 * mark + 19_200 * (1 - on)) for mark in range(15) for on in (1, 0)]
        shooter.send(*(f"carrier {on} {cycle}" for on, cycle in edges))
        assert [target.line() for _ in edges] == [f"carrier 0 {on} {cycle}" for on, cycle in edges]
        seen = arena.look()
        assert (seen["a0"]["hits"], seen["b1"]["hits"]) == (0, 1)
        target.send("carrier 1 5")
        assert shooter.line() == "carrier 1 1 5"


def test_ambient_light_shines_on_all(new_arena: Callable[..., Arena]) -> None:
    arena = new_arena("--lamp", "--sun", "--remote")
    with Hardware(arena, "a0") as robot, Hardware(arena, "b1") as other:
        for hardware in (robot, other):
            lines = [hardware.line() for _ in range(2 + 68)]
            assert lines[:2] == ["light 1", "lamp 1"]
            assert [line.split()[:3] for line in lines[2:]] == [["carrier", "15", "1"], ["carrier", "15", "0"]] * 34
        assert not arena.look()["a0"]["lit"]


@pytest.mark.slow
def test_light_follows_the_beam_at_once(arena: Arena) -> None:
    with ExitStack() as stack:
        shooter, target = two_face_to_face(stack, arena)
        delays = []
        for n in range(20):
            shooter.send(f"beam {(n + 1) % 2}")
            start = time.perf_counter()
            assert target.line() == f"light {(n + 1) % 2}"
            delays.append(time.perf_counter() - start)
        assert statistics.median(delays) < 0.02, delays  # at the next tick of the view it would be 0.04


def test_a_beam_that_sweeps_over_a_robot_lights_it(arena: Arena) -> None:
    with ExitStack() as stack:
        shooter, target = two_face_to_face(stack, arena)
        shooter.face(math.pi / 2)
        shooter.send("beam 1")
        shooter.face(0.0)
        assert target.line() == "light 1"
        shooter.face(-math.pi / 2)
        assert target.line() == "light 0"


def test_a_wall_blocks_the_beam(arena: Arena) -> None:
    with Hardware(arena, "a0") as shooter, Hardware(arena, "b1") as target:
        shooter.drive_to(0.6, 0.15)
        shooter.drive_to(0.69, 0.6)
        shooter.face(0.0)
        target.drive_to(0.92, 1.03)
        target.drive_to(0.92, 0.6)
        assert (shooter.line(), target.line()) == ("light 0", "light 0")
        shooter.send("beam 1")
        until(lambda: arena.look()["a0"]["beam"], 5)
        assert not arena.look()["b1"]["lit"]
        target.drive_to(0.92, 0.86)  # out of the cover, and in sight over its end
        shooter.face(math.atan2(0.26, 0.23))
        assert target.line() == "light 1"


def test_a_robot_that_leaves_while_shooting_leaves_no_light(arena: Arena) -> None:
    with ExitStack() as stack:
        shooter, target = two_face_to_face(stack, arena)
        shooter.send("beam 1")
        assert target.line() == "light 1"
        shooter.close()
        assert target.line() == "light 0"


def test_a_robot_that_connects_again_stands_where_it_was(arena: Arena) -> None:
    with Hardware(arena, "virtual3") as robot:
        robot.drive_to(0.6, 0.2)
        before = robot.look()
    until(lambda: not arena.look(), 5, "robot gone")
    with Hardware(arena, "virtual3", wheels=(-5_000_000, 77)) as robot:  # it has gone on counting meanwhile
        assert robot.line() == "light 0"
        assert robot.look() == before
        assert before["id"] == 3


def test_the_newer_of_two_connections_with_one_name_wins(arena: Arena) -> None:
    with Hardware(arena, "virtual0") as older, Hardware(arena, "virtual0") as newer:
        assert newer.line() == "light 0"
        assert [older.line(), older.line(), older.line()] == [
            "light 0",
            "error a newer connection has this robot's name",
            "",
        ]
        newer.drive_to(0.6, 0.2)


@pytest.mark.parametrize(
    ("hello", "data", "complaint"),
    [
        (None, b"GET / HTTP/1.1\r\n", "error first line must be"),
        (None, b"wheels 0 0\n", "error first line must be"),
        (None, b"x" * 100_000, "error line longer than 128 bytes"),
        ("bad0", b"fly 1\n", "error expected"),
        ("bad0", b"\xff\xfe\x00\x01\n", "error expected"),
        ("bad0", b"wheels 100000 0\n", "error wheels cannot turn"),
        ("bad0", b"beam " + b"1" * 5000, "error line longer than 128 bytes"),
    ],
    ids=["http", "no hello", "endless", "unknown word", "binary", "wheels jump", "long line"],
)
def test_garbage_closes_only_its_own_connection(arena: Arena, hello: str | None, data: bytes, complaint: str) -> None:
    with Hardware(arena, "good1") as good, Hardware(arena, hello) as bad:
        assert good.line() == "light 0"
        if hello:
            assert bad.line() == "light 0"
        bad.send_raw(data)
        assert bad.line().startswith(complaint)
        assert bad.line() == ""
        until(lambda: list(arena.look()) == ["good1"], 5)
        place = good.look()["x"]
        good.turn_wheels(0.1, 0.1)
        until(lambda: abs(good.look()["x"] - place) > 0.02, 5)


def test_half_a_line_at_the_end_of_a_connection_is_ignored(arena: Arena) -> None:
    with Hardware(arena, "a0") as robot:
        robot.send_raw(b"beam ")
    until(lambda: "a0 is gone" in arena.program.output, 5)


def test_a_ninth_robot_is_told_that_the_floor_is_full(arena: Arena) -> None:
    with ExitStack() as stack:
        for n in range(8):
            assert stack.enter_context(Hardware(arena, f"virtual{n}")).line() == "light 0"
        late = stack.enter_context(Hardware(arena, "virtual8"))
        assert late.line() == "error the arena is full (8 robots)"
        assert late.line() == ""
        assert len(arena.look()) == 8


def test_of_too_many_strangers_the_slowest_gives_way_and_never_a_robot(arena: Arena) -> None:
    with ExitStack() as stack:
        robot = stack.enter_context(Hardware(arena, "a0"))
        assert robot.line() == "light 0"
        strangers = [stack.enter_context(Hardware(arena, None)) for _ in range(MAX_STRANGERS + 1)]
        assert strangers[0].line() == "error too many connections"
        assert strangers[0].line() == ""
        late = stack.enter_context(Hardware(arena, "b1"))
        assert late.line() == "light 0"
        robot.turn_wheels(0.1, 0.1)


def test_a_robot_that_tells_without_end_holds_up_nobody(arena: Arena) -> None:
    """Nor does it read."""
    with Hardware(arena, "rude0") as rude, ThreadPoolExecutor(1) as talker:
        ending = threading.Event()
        talking = talker.submit(talk, rude, ending)
        try:
            for number in range(1, 6):
                with Hardware(arena, f"good{number}") as good:
                    assert good.line() == "light 0"
                    assert f"good{number}" in arena.look()
        finally:
            ending.set()
        assert talking.result() > 100_000, "it has not been told to wait"


def talk(rude: Hardware, ending: threading.Event) -> int:
    """Until `ending`; how many bytes."""
    told = 0
    while not ending.is_set():
        with suppress(TimeoutError):
            rude.send_raw(b"wheels 1 1\nwheels 2 2\n" * 500)
            told += 11_000
    return told


def test_a_robot_that_does_not_read_is_disconnected_and_the_others_go_on(arena: Arena) -> None:
    with ExitStack() as stack:
        shooter, _target = two_face_to_face(stack, arena)
        for number in range(1000):
            shooter.send(*(f"carrier {edge % 2} {1000 * number + edge}" for edge in range(1, 41)))
            if "does not read what we send" in arena.program.output:
                break
        arena.program.wait_for("does not read what we send: disconnected")
        until(lambda: list(arena.look()) == ["a0"], 5)
        shooter.turn_wheels(0.1, 0.1)
        with Hardware(arena, "c2") as other:
            assert other.line() == "light 0"
        assert shooter.look()["id"] == 0


@pytest.mark.slow
def test_who_says_nothing_is_disconnected(arena: Arena) -> None:
    with Hardware(arena, None) as silent:
        silent.wait_longer(10)
        assert silent.line() == "error no hello"


def test_a_robot_that_resets_its_connection_does_no_harm(arena: Arena) -> None:
    with Hardware(arena, "good1") as good:
        with Hardware(arena, "bad0") as bad:
            assert bad.line() == "light 0"
            bad.reset()
        until(lambda: list(arena.look()) == ["good1"], 5)
        place = good.look()["x"]
        good.turn_wheels(0.1, 0.1)
        until(lambda: abs(good.look()["x"] - place) > 0.02, 5)
