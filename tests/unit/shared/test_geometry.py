"""Motion from wheel rotation, and rays, against closed forms."""

import math

import pytest

from laser_bot_battle.geometry import (
    METRES_PER_HALF_STEP,
    ROBOT_RADIUS,
    TRACK,
    Pose,
    nearest_on_wall,
    ray_to_disc,
    ray_to_wall,
    roll,
    wrap,
)

ORIGIN = Pose(0.0, 0.0, 0.0)


def test_full_speed_is_seven_centimetres_a_second() -> None:
    assert pytest.approx(0.0707, abs=1e-4) == 1024 * METRES_PER_HALF_STEP


def test_equal_wheels_drive_straight_ahead() -> None:
    pose = roll(Pose(1.0, 2.0, math.pi / 3), 0.5, 0.5)
    assert pose.point == pytest.approx((1.0 + 0.25, 2.0 + 0.5 * math.sin(math.pi / 3)))
    assert pose.heading == pytest.approx(math.pi / 3)


def test_opposite_wheels_turn_in_place() -> None:
    quarter = math.pi / 2 * TRACK / 2
    pose = roll(ORIGIN, -quarter, quarter)
    assert pose.point == pytest.approx((0.0, 0.0))
    assert pose.heading == pytest.approx(math.pi / 2)


@pytest.mark.parametrize("turn", [0.3, math.pi, -2.0])
def test_unequal_wheels_drive_a_circular_arc(turn: float) -> None:
    radius = 0.4  # of the circle, whose centre is to the left at (0, 0.4)
    pose = roll(ORIGIN, turn * (radius - TRACK / 2), turn * (radius + TRACK / 2))
    assert pose.point == pytest.approx((radius * math.sin(turn), radius * (1 - math.cos(turn))))
    assert pose.heading == pytest.approx(wrap(turn))


def test_one_long_arc_is_the_sum_of_many_short_ones() -> None:
    pose = ORIGIN
    for _ in range(1000):
        pose = roll(pose, 0.0007, 0.001)
    once = roll(ORIGIN, 0.7, 1.0)
    assert (pose.x, pose.y, pose.heading) == pytest.approx((once.x, once.y, once.heading))


def test_the_emitter_is_in_the_nose() -> None:
    assert Pose(1.0, 1.0, math.pi / 2).emitter == pytest.approx((1.0, 1.06))


def test_a_ray_ends_at_the_wall_that_it_crosses() -> None:
    assert ray_to_wall((0, 0), (1, 0), (2, -1, 2, 1)) == pytest.approx(2)


@pytest.mark.parametrize("wall", [(2, 1, 2, 3), (-2, -1, -2, 1), (0, 1, 5, 1)], ids=["beside", "behind", "parallel"])
def test_a_ray_misses_a_wall_that_it_does_not_cross(wall: tuple[float, float, float, float]) -> None:
    assert ray_to_wall((0, 0), (1, 0), wall) == math.inf


def test_a_ray_ends_at_the_near_side_of_a_disc() -> None:
    assert ray_to_disc((0, 0), (1, 0), (1, 0)) == pytest.approx(1 - ROBOT_RADIUS)


@pytest.mark.parametrize("centre", [(1, 0.2), (-1, 0)], ids=["beside", "behind"])
def test_a_ray_misses_a_disc_that_it_does_not_cross(centre: tuple[float, float]) -> None:
    assert ray_to_disc((0, 0), (1, 0), centre) == math.inf


@pytest.mark.parametrize(
    ("point", "nearest"), [((0.5, 1), (0.5, 0)), ((-1, 1), (0, 0)), ((3, 0), (1, 0))], ids=["middle", "start", "end"]
)
def test_the_nearest_point_of_a_wall(point: tuple[float, float], nearest: tuple[float, float]) -> None:
    assert nearest_on_wall(point, (0, 0, 1, 0)) == pytest.approx(nearest)
