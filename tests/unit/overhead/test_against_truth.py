"""The tracker held against where robots really are: it looks at painted pictures, in simulated time."""

import random

import pytest

from laser_bot_battle.floor import Floor
from sim.arena.overhead.conditions import Conditions
from sim.arena.overhead.picture import FOOT_PERIOD
from tests.support.floors import BATTLE_FLOOR, DUEL_FLOOR
from tests.support.overhead import Hall, Miss

ROBOTS = 8
HALL = Floor.of(4, 2.25, (), tuple((0.5 + 0.75 * column, 0.7 * row) for column in range(4) for row in (1, 2)))
FIRST = 0.5  # s in which the tracker finds its way
WORST = Conditions(tilt=15, lens=-0.3, noise=10, exposure=0.03, shade=0.5, print=0.98)


def misses(hall: Hall, seconds: float) -> list[Miss]:
    """Of all robots, which drive at full speed, whenever their places are oldest."""
    found: list[Miss] = []
    for _ in hall.play(seconds, random.Random(3)):
        if hall.now > FIRST:
            now = hall.misses()
            assert now.keys() == set(range(ROBOTS))
            found += now.values()
    return found


def p95(values: list[float]) -> float:
    return sorted(values)[int(0.95 * len(values))]


def assert_right(found: list[Miss]) -> None:
    """Within 15 mm and 3 degrees."""
    assert p95([miss.distance for miss in found]) <= 0.015
    assert p95([miss.angle for miss in found]) <= 3


@pytest.mark.parametrize(
    "conditions",
    [
        Conditions(height=1),
        Conditions(height=10),
        Conditions(tilt=15),
        Conditions(lens=-0.3),
        Conditions(lens=0.3),
        Conditions(noise=20),
        Conditions(exposure=0.06),
        Conditions(shade=0.8),
        Conditions(print=0.98),
    ],
    ids=lambda conditions: conditions.options,
)
def test_places_are_right_at_the_limit_of_each_condition(conditions: Conditions) -> None:
    assert_right(misses(Hall(BATTLE_FLOOR, ROBOTS, conditions), FIRST + 0.6))


def test_places_are_right_under_the_worst_conditions_together() -> None:
    assert_right(misses(Hall(BATTLE_FLOOR, ROBOTS, WORST), 3))


def test_places_are_right_on_the_floor_of_a_hall() -> None:
    assert_right(misses(Hall(HALL, ROBOTS, Conditions(height=3)), 3))


@pytest.mark.parametrize("stays", [0.12, 0.4])
def test_a_covered_robot_is_found_again_at_once(stays: float) -> None:
    """A foot stays for 0.6 s, in which the robot keeps a place, and for 2 s, in which it loses that."""
    hall = Hall(BATTLE_FLOOR, 4, Conditions(foot=stays))
    covered, gone = 3, FOOT_PERIOD * (1 + stays)  # starts in the quarter that is covered second
    hall.now = FOOT_PERIOD - FIRST
    states = set()
    for _ in hall.play(FIRST + FOOT_PERIOD * stays + 0.3, random.Random(5)):
        if FOOT_PERIOD + 0.4 < hall.now < gone:
            one = hall.seen().get(covered)
            states.add(one.covered if one else None)
    assert states == ({True} if stays < 0.2 else {True, None})
    found = hall.seen()[covered]
    assert not found.covered
    assert hall.miss(found).distance < 0.015


def exchanged(hall: Hall, seconds: float, rate: float) -> list[int]:
    """Robots that were ever said to be where another one may stand."""
    return [
        number
        for _ in hall.play(seconds, random.Random(7), rate)
        for number, one in hall.seen().items()
        if not one.covered and hall.miss(one).distance > 0.075
    ]


def test_crowding_robots_are_never_exchanged() -> None:
    hall = Hall(DUEL_FLOOR, ROBOTS)
    assert exchanged(hall, 8, 15) == []
    assert hall.seen().keys() == set(range(ROBOTS))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_robots_that_crowd_for_ten_minutes_are_never_exchanged() -> None:
    """With fewer pictures than any camera takes, and under feet: that is harder."""
    hall = Hall(DUEL_FLOOR, ROBOTS, Conditions(foot=0.15, exposure=0.03, print=0.98))
    assert exchanged(hall, 600, 5) == []


def test_a_tag_that_two_robots_carry_or_none_should_is_told_by_its_number() -> None:
    hall = Hall(BATTLE_FLOOR, 4)
    for name in ("guest3", "guest150", "guest201"):
        hall.world.arrive(name)
    list(hall.play(0.5))
    assert sorted(hall.tracker.troubles(hall.now).values()) == [
        "floor tag 201 is seen 2 times: take away all but the one at its place",
        "robot tag 3 is seen 2 times: only one robot may carry it",
        "tag 150 belongs to no robot and not to this floor",
    ]
    assert {0, 1, 2} <= hall.seen().keys()
