"""Where the robots are between two messages."""

import math
from itertools import pairwise

import pytest

from laser_bot_battle.geometry import FULL_SPEED, Point, Pose
from server.bots.game import Floor, Positions
from server.bots.mind import Command
from server.bots.sight import AGE, BLIND_AFTER, MOST, OBEYED, OwnWay, Sight

FLOOR = Floor(2.0, 2.0, ())


def sight(*places: tuple[float, Point]) -> Sight:
    """Robot 3 was seen at these places at these times."""
    seen = Sight()
    for at, (x, y) in places:
        seen.see(at, Positions(FLOOR, {3: Pose(x, y, 0.0)}))
    return seen


def test_a_robot_that_drives_drives_on() -> None:
    seen = sight((1.0, (1.0, 1.0)), (1.2, (1.01, 1.0)))
    assert seen.points(1.3)[3] == pytest.approx((1.01 + 0.05 * (0.1 + AGE), 1.0))


def test_but_not_for_long() -> None:
    seen = sight((1.0, (1.0, 1.0)), (1.2, (1.01, 1.0)))
    assert seen.points(2.0)[3] == pytest.approx((1.01 + 0.05 * MOST, 1.0))


@pytest.mark.parametrize("places", [[(1.0, (1.0, 1.0))], [(1.0, (0.0, 0.0)), (9.0, (1.0, 1.0))]], ids=["new", "back"])
def test_a_robot_that_was_not_seen_of_late_stands(places: list[tuple[float, Point]]) -> None:
    assert sight(*places).points(places[-1][0] + 0.5)[3] == (1.0, 1.0)


def test_after_a_second_without_a_message_nothing_is_known() -> None:
    seen = sight((1.0, (1.0, 1.0)))
    assert not seen.is_blind(1.0 + BLIND_AFTER)
    late = 1.1 + BLIND_AFTER
    assert (seen.is_blind(late), seen.seen(3, late), seen.points(late)) == (True, None, {})
    assert Sight().is_blind(0.0)


def test_who_is_told_of_no_robot_is_blind() -> None:
    seen = sight((1.0, (1.0, 1.0)))
    seen.see(1.1, Positions(FLOOR, {}))
    assert seen.is_blind(1.1)


def test_a_robot_is_where_its_commands_have_brought_it() -> None:
    way, start = OwnWay(), Pose(1.0, 1.0, 0.0)
    way.commanded(1.0, Command(linear_x=1))
    way.commanded(2.0, Command(angular_z=-1))
    way.commanded(2.5, Command())
    assert way.since(0.5, start, 1.0) == start, "its wheels do not obey yet"
    assert way.since(0.5, start, 1.5).x == pytest.approx(1.0 + FULL_SPEED * (0.5 - OBEYED))
    turned = way.since(0.5, start, 3.0)
    assert turned.point == pytest.approx((1.0 + FULL_SPEED, 1.0))
    assert turned.heading == pytest.approx(math.radians(67.5) / 2, abs=0.01), "67.5 degrees a second"
    assert way.since(2.0 + OBEYED, start, 3.0).heading == pytest.approx(turned.heading), "what was seen is not added"


def test_between_two_commands_it_moves_on_evenly() -> None:
    way = OwnWay()
    way.commanded(1.0, Command(linear_x=-1, angular_z=1))
    steps = [way.since(0.9, Pose(1.0, 1.0, 0.0), 1.1 + n * 0.04) for n in range(10)]
    lengths = [math.dist(one.point, other.point) for one, other in pairwise(steps)]
    assert lengths == pytest.approx([lengths[0]] * 9, rel=1e-3)
    assert all(one.x > other.x for one, other in pairwise(steps))
