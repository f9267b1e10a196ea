"""Coded light: packets of marks, and whom all of a packet has met."""

import math

import pytest

from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import METRES_PER_HALF_STEP, Pose
from sim.arena.ambient import US, key_press
from sim.arena.carrier import CYCLES_PER_SECOND, MARKS
from sim.arena.world import World

FLOOR = Floor.of(2.0, 2.0, (), ((0.2, 0.2), (1.8, 1.8), (0.2, 1.8)))
MARK, SPACE = 1200 * 16, 600 * 16


@pytest.fixture
def world() -> World:
    """`a` looks at `b`; `c` stands beside them."""
    world = World(FLOOR)
    for name, pose in {"a": Pose(0.5, 1, 0), "b": Pose(1, 1, math.pi), "c": Pose(1, 0.5, 0)}.items():
        world.arrive(name).pose = pose
        world.turn_wheels(name, 0, 0)
    return world


def flash(world: World, name: str, start: int, marks: int = MARKS) -> list[tuple[int, bool, dict[str, bool]]]:
    """Marks from `start` on; when which robots were told what."""
    seen = []
    for n in range(marks):
        for cycle, on in ((start + n * (MARK + SPACE), True), (start + n * (MARK + SPACE) + MARK, False)):
            seen.append((cycle, on, told(world, name, on, cycle)))
    return seen


def told(world: World, name: str, on: bool, cycle: int) -> dict[str, bool]:
    """Who is told what of a carrier."""
    return {robot.name: seen for robot, seen in world.set_carrier(name, on, cycle, 0.0)}


def hits(world: World) -> dict[str, int]:
    return {name: robot.hits for name, robot in world.robots.items()}


def test_each_edge_is_for_the_robot_in_the_beam(world: World) -> None:
    assert flash(world, "a", 0, marks=2) == [
        (0, True, {"b": True}),
        (MARK, False, {"b": False}),
        (MARK + SPACE, True, {"b": True}),
        (2 * MARK + SPACE, False, {"b": False}),
    ]


def test_a_whole_packet_is_a_hit(world: World) -> None:
    flash(world, "a", 0, marks=MARKS - 1)
    assert hits(world) == {"a": 0, "b": 0, "c": 0}
    flash(world, "a", CYCLES_PER_SECOND)
    flash(world, "a", 2 * CYCLES_PER_SECOND)
    assert hits(world) == {"a": 0, "b": 2, "c": 0}


def test_a_packet_that_lights_a_robot_for_a_part_of_it_is_none(world: World) -> None:
    flash(world, "a", 0, marks=3)
    world.robots["b"].pose = Pose(1, 1.6, 0)
    assert flash(world, "a", 3 * (MARK + SPACE), marks=1)[0] == (3 * (MARK + SPACE), True, {"b": False})
    world.robots["b"].pose = Pose(1, 1, 0)
    flash(world, "a", 4 * (MARK + SPACE), marks=MARKS - 4)
    assert hits(world)["b"] == 0


def test_who_has_seen_a_mark_begin_sees_its_end(world: World) -> None:
    world.set_carrier("a", True, 0, 0.0)
    away = round(0.6 / METRES_PER_HALF_STEP)
    world.robots["b"].pose = Pose(1, 1, math.pi / 2)
    world.turn_wheels("b", -away, away)
    assert told(world, "a", False, MARK) == {"b": False}


def test_a_robot_that_leaves_within_a_packet_takes_no_part(world: World) -> None:
    world.set_carrier("a", True, 0, 0.0)
    world.leave("b")
    assert told(world, "a", False, MARK) == {}
    world.set_carrier("a", True, MARK + SPACE, 0.0)
    world.leave("a")
    assert world.arrive("a").carrier.on is False


def test_a_state_that_is_told_again_is_no_edge_but_news(world: World) -> None:
    assert told(world, "a", False, 0) == {}
    assert told(world, "a", True, 10) == {"b": True}
    world.robots["b"].pose = Pose(1, 1.6, 0)
    assert told(world, "a", True, 20) == {"b": True}
    flash(world, "a", MARK, marks=MARKS - 1)
    assert hits(world)["b"] == 0


def test_a_robot_that_has_seen_a_part_of_a_packet_hears_of_its_rest_only(world: World) -> None:
    flash(world, "a", 0)
    world.robots["b"].pose = Pose(1, 1.6, 0)
    assert flash(world, "a", CYCLES_PER_SECOND, marks=1) == [
        (CYCLES_PER_SECOND, True, {}),
        (CYCLES_PER_SECOND + MARK, False, {}),
    ]


def test_a_key_of_a_remote_control_is_a_frame_of_nec_and_two_repeats() -> None:
    frame, *repeats = key_press(0x04, 0xA5)
    marks = [(end - start) // US for (start, _), (end, _) in zip(frame[::2], frame[1::2], strict=True)]
    spaces = [(start - end) // US for (end, _), (start, _) in zip(frame[1::2], frame[2::2], strict=False)]
    assert marks == [9000, *[560] * 33]
    assert spaces[0] == 4500
    bits = [space > 1000 for space in spaces[1:]]
    assert [sum(bit << n for n, bit in enumerate(bits[at : at + 8])) for at in (0, 8, 16, 24)] == [4, 0xFB, 0xA5, 0x5A]
    assert repeats == [[(0, True), (9000 * US, False), (11250 * US, True), (11810 * US, False)]] * 2
