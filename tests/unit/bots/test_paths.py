"""Ways around walls."""

import math

import pytest

from laser_bot_battle.geometry import Point
from server.bots.paths import Paths
from tests.support.floors import BATTLE_FLOOR

COURSE = Paths(BATTLE_FLOOR.width, BATTLE_FLOOR.height, BATTLE_FLOOR.walls)


def test_a_free_way_is_straight() -> None:
    assert COURSE.next_point((0.2, 0.2), (0.8, 0.2)) == (0.8, 0.2)


def test_a_wall_is_driven_around() -> None:
    point = COURSE.next_point((0.65, 0.6), (0.95, 0.6))
    assert point != (0.95, 0.6)
    assert abs(point[1] - 0.6) > 0.1


@pytest.mark.parametrize("goal", [start[:2] for start in BATTLE_FLOOR.starts[1:]])
def test_every_start_position_is_reached_from_the_first(goal: Point) -> None:
    place = BATTLE_FLOOR.starts[0][:2]
    for _ in range(20):
        if place == goal:
            break
        place = COURSE.next_point(place, goal)
        assert COURSE.has_room(place)
    assert place == goal


def test_a_start_at_a_wall_and_a_goal_within_one_still_give_a_way() -> None:
    place: Point = (0.075, 0.6)
    for _ in range(3):
        place = COURSE.next_point(place, (0.8, 0.6))
        assert COURSE.has_room(place)
    assert math.dist(place, (0.8, 0.6)) < 0.3


def test_a_floor_without_room_is_driven_straight() -> None:
    assert Paths(0.1, 0.1, [(0, 0, 0.1, 0.1)]).next_point((0, 0), (0.1, 0)) == (0.1, 0)
