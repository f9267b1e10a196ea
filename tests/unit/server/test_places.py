"""The rules of place: what the referee decides by where the robots are."""

import math

import pytest

from server.game.replay import replay
from server.game.rules import Rules
from server.game.sight import REMEMBERED, SEEN, Moment, Sides, beyond, could_meet
from server.ros.status import to_message
from tests.unit.server.conftest import Match

EAST, NORTH, WEST = 0.0, math.pi / 2, math.pi
WIDTH, HEIGHT = 4.0, 2.0
WALL = (1.0, 0.5, 1.0, 1.5)


def see(match: Match, *poses: tuple[float, float, float], walls=()) -> None:
    """Robots 0, 1 and so on stand so."""
    match.referee.see(Moment(match.now, tuple(walls), dict(enumerate(poses))), WIDTH, HEIGHT)


def meets(match: Match) -> bool:
    """Robot 0 fires, and robot 1 receives its packet."""
    match.wait(1)
    assert match.referee.shot(0, match.now)
    match.now += 0.1
    return match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)


@pytest.fixture
def fire(new_match) -> Match:
    match = new_match(rules=Rules(light="coded", line_of_fire=2.0))
    match.start("ada", "bob")
    return match


@pytest.mark.parametrize(
    ("victim", "heading", "walls", "meets"),
    [
        ((2.0, 1.0), EAST, (), True),
        ((2.4, 1.0), EAST, (), True),
        ((2.8, 1.0), EAST, (), False),
        ((0.5, 0.3), NORTH, (), False),
        ((0.5, 1.7), NORTH, (), True),
        ((2.0, 1.0), WEST, (), False),
        ((2.0, 2.0), EAST, (), False),
        ((2.0, 1.4), EAST, (), True),
        ((2.0, 1.0), EAST, (WALL,), False),
        ((2.0, 1.0), EAST, ((1.0, 1.02, 1.0, 1.5),), True),
        ((2.0, 1.0), EAST, ((2.5, 0.0, 2.5, 2.0),), True),
        ((0.6, 1.0), WEST, (WALL,), True),
    ],
    ids=[
        *("ahead", "at the end of its reach", "too far", "behind its side", "ahead, northwards", "behind", "aside"),
        *("a little aside", "behind a wall", "half behind a wall", "before a wall", "touching"),
    ],
)
def test_light_meets_what_is_near_ahead_and_not_behind_a_wall(victim, heading, walls, meets):
    assert could_meet((0.5, 1.0, heading), (*victim, 0.0), walls, 2.0) is meets


def test_a_hit_counts_only_if_the_shooter_can_have_fired_it_from_there(fire):
    match = fire
    match.wait(1)
    see(match, (0.5, 1, EAST), (2.0, 1, EAST))
    assert match.referee.shot(0, match.now)
    assert match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)
    match.wait(2)
    see(match, (0.5, 1, WEST), (2.0, 1, EAST))
    assert match.referee.shot(0, match.now)
    assert not match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)
    assert (match.player("bob").life, match.player("ada").hits) == (90, 1)


def test_a_robot_that_has_turned_away_since_its_shot_has_fired_it(fire):
    match = fire
    match.wait(1)
    see(match, (0.5, 1, EAST), (2.0, 1, EAST))
    assert match.referee.shot(0, match.now)
    match.now += REMEMBERED - 0.5
    see(match, (0.5, 1, WEST), (2.0, 1, EAST))
    assert match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)


def test_without_the_rule_or_without_places_light_counts_from_anywhere(new_match, fire):
    assert meets(fire), "nobody has told where they are"
    see(fire, (0.5, 1, WEST), (2.0, 1, EAST))
    fire.wait(2 * REMEMBERED)
    assert meets(fire), "nobody tells any more"
    free = new_match(rules=Rules(light="coded"))
    free.start("ada", "bob")
    free.wait(1)
    see(free, (0.5, 1, WEST), (2.0, 1, EAST))
    assert free.referee.shot(0, free.now)
    assert free.referee.shot_hit(1, 0, 0, free.now, shots_told=True)


@pytest.mark.parametrize(
    ("pose", "sides"),
    [
        ((2.0, 1.0, EAST), Sides()),
        ((3.93, 1.0, EAST), Sides(ahead=True)),
        ((3.93, 1.0, WEST), Sides(behind=True)),
        ((3.93, 1.0, NORTH), Sides()),
        ((0.07, 1.0, WEST), Sides(ahead=True)),
        ((2.0, 0.05, NORTH), Sides(behind=True)),
        ((2.0, 1.95, NORTH), Sides(ahead=True)),
        ((0.05, 0.05, math.radians(-45)), Sides(ahead=True, behind=True)),
        ((4.5, 1.0, EAST), Sides(ahead=True)),
    ],
)
def test_at_the_edge_a_robot_may_not_drive_out(pose, sides):
    assert beyond(pose, WIDTH, HEIGHT) == sides


@pytest.fixture
def fenced(new_match) -> Match:
    match = new_match(rules=Rules(fence=True))
    match.start("ada", "bob")
    return match


def test_who_comes_to_the_edge_is_stopped_and_whoever_turns_is_free(fenced):
    see(fenced, (3.9, 1, EAST), (2, 1, EAST))
    see(fenced, (3.93, 1, EAST), (2, 1, EAST))
    assert [user.fence for user in to_message(fenced.state).users] == [1, 0]
    see(fenced, (3.93, 1, WEST), (2, 1, EAST))
    assert fenced.player("ada").fence == Sides(behind=True)
    see(fenced, (3.93, 1, NORTH), (2, 1, EAST))
    told = [str(one.event) for one in fenced.referee.take_journal() if "edge" in str(one.event)]
    assert told == [
        "ada (robot 0) is at the floor's edge and cannot drive on forwards",
        "ada (robot 0) is at the floor's edge and cannot drive on backwards",
        "ada (robot 0) is clear of the floor's edge",
    ]


def test_without_the_rule_nobody_is_stopped(match):
    match.start("ada", "bob")
    see(match, (3.93, 1, EAST), (2, 1, EAST))
    assert match.player("ada").fence == Sides()


@pytest.mark.parametrize("how", ["not seen", "nothing is seen"])
def test_nobody_is_held_by_what_nobody_sees(fenced, how):
    see(fenced, (3.93, 1, EAST), (2, 1, EAST))
    assert fenced.player("ada").fence == Sides(ahead=True)
    if how == "not seen":
        fenced.referee.see(Moment(fenced.now, (), {1: (2, 1, EAST)}), WIDTH, HEIGHT)
    else:
        fenced.wait(SEEN - 0.1)
        assert fenced.player("ada").fence == Sides(ahead=True)
        fenced.wait(0.2)
    assert fenced.player("ada").fence == Sides()


def test_a_battle_with_a_fence_can_be_played_again(fenced):
    see(fenced, (3.93, 1, EAST), (2, 1, EAST))
    fenced.hit("bob", 10)
    assert [placing.name for placing in replay(fenced.referee.take_journal())] == ["ada", "bob"]
