"""Who stands in the light: the cone, its range, and what blocks it."""

import math

import pytest

from laser_bot_battle.geometry import EMITTER_OFFSET, ROBOT_RADIUS, Pose, free_distance
from sim.arena.light import BEAM_HALF_ANGLE, BEAM_RANGE, shines_on

SHOOTER = Pose(0.0, 0.0, 0.0)
REACH = EMITTER_OFFSET + BEAM_RANGE + ROBOT_RADIUS  # from centre to centre


def at(distance: float, angle: float) -> tuple[float, float]:
    """A point as seen from the shooter's emitter."""
    return EMITTER_OFFSET + distance * math.cos(angle), distance * math.sin(angle)


@pytest.mark.parametrize("x", [2 * ROBOT_RADIUS, 0.5, REACH - 0.01], ids=["touching", "near", "far"])
def test_a_robot_straight_ahead_is_lit(x: float) -> None:
    assert shines_on(SHOOTER, (x, 0), [], [])


def test_a_robot_out_of_range_is_dark() -> None:
    assert not shines_on(SHOOTER, (REACH + 0.01, 0), [], [])


@pytest.mark.parametrize("side", [1, -1])
def test_the_cone_has_an_edge(side: int) -> None:
    distance = 0.6
    edge = BEAM_HALF_ANGLE + math.asin(ROBOT_RADIUS / distance)
    assert shines_on(SHOOTER, at(distance, side * (edge - 0.02)), [], [])
    assert not shines_on(SHOOTER, at(distance, side * (edge + 0.02)), [], [])


def test_a_robot_behind_the_shooter_is_dark() -> None:
    assert not shines_on(SHOOTER, (-0.2, 0), [], [])


def test_the_beam_follows_the_heading() -> None:
    assert shines_on(Pose(0, 0, math.pi), (-0.5, 0), [], [])


def test_a_wall_in_between_keeps_a_robot_dark() -> None:
    assert not shines_on(SHOOTER, (0.5, 0), [(0.3, -0.2, 0.3, 0.2)], [])


def test_a_wall_behind_a_robot_does_not() -> None:
    assert shines_on(SHOOTER, (0.5, 0), [(0.7, -0.2, 0.7, 0.2)], [])


def test_a_robot_that_looks_out_from_behind_a_wall_is_lit() -> None:
    assert shines_on(SHOOTER, (0.5, 0), [(0.3, 0, 0.3, 0.2)], [])


def test_a_robot_in_the_shadow_of_another_is_dark() -> None:
    assert not shines_on(SHOOTER, (0.6, 0), [], [(0.3, 0)])


def test_a_robot_beside_another_is_lit() -> None:
    assert shines_on(SHOOTER, (0.6, 0), [], [(0.3, 0.2)])


def test_a_ray_ends_at_what_is_nearest() -> None:
    wall = (0.5, -1, 0.5, 1)
    assert free_distance((0, 0), 0, [wall], [], 0.9) == pytest.approx(0.5)
    assert free_distance((0, 0), 0, [wall], [(0.3, 0)], 0.9) == pytest.approx(0.3 - ROBOT_RADIUS)
    assert free_distance((0, 0), math.pi, [wall], [], 0.9) == 0.9
