"""Robot IDs: unique, lasting for named robots, 0 to 127."""

import pytest

from laser_bot_battle.names import ROBOT_IDS
from server.game.robot import Robot, Robots


def register(robots, *callers):
    return [enter(robots, caller, 0.0) for caller in callers]


def enter(robots, caller, now):
    robot_id, name = robots.id_for(caller)
    if robot_id is not None:
        robots.put(robot_id, name, now)
        robots.link(robot_id, True)
    return robot_id


def the(robots, robot_id) -> Robot:
    robot = robots.get_robot(robot_id)
    assert robot is not None
    return robot


def remove(robots, *ids):
    for robot_id in ids:
        robots.del_robot(robot_id)


def test_ids_start_at_zero_and_the_lowest_free_one_is_given():
    robots = Robots()
    assert register(robots, "/unnamed", "/unnamed", "/unnamed") == [0, 1, 2]
    remove(robots, 1)
    assert register(robots, "/unnamed") == [1]
    assert [robot.id for robot in robots] == [0, 1, 2]


def test_a_named_robot_gets_its_id_back():
    robots = Robots()
    assert register(robots, "/a", "/b") == [0, 1]
    remove(robots, 0, 1)
    assert register(robots, "/b", "/a") == [1, 0]


def test_strangers_do_not_get_the_id_of_an_absent_named_robot():
    robots = Robots({"/a": 0, "/b": 2})
    assert register(robots, "/unnamed", "/c", "/b") == [1, 3, 2]


def test_registering_again_while_listed_is_the_same_robot():
    robots = Robots()
    register(robots, "/a")
    the(robots, 0).user = "ada"
    assert enter(robots, "/a", 7.0) == 0
    assert (the(robots, 0).user, the(robots, 0).alive_at) == ("ada", 7.0)
    assert len(list(robots)) == 1


@pytest.mark.parametrize(
    "caller", ["/unnamed", "", "unnamed", "/rosservice_4711_1700000000000", "/a\nb", "/ünïcode", "/" + "a" * 300]
)
def test_callers_without_a_lasting_name_are_never_remembered(caller):
    robots = Robots()
    assert register(robots, caller, caller) == [0, 1]
    assert robots.known == {}


def test_named_robots_are_remembered():
    robots = Robots({"/old": 5})
    register(robots, "/unnamed", "/new")
    assert robots.known == {"/old": 5, "/new": 1}


def test_a_roster_that_gives_one_id_twice_still_gives_unique_ids():
    robots = Robots({"/a": 0, "/b": 0})
    ids = register(robots, "/a", "/b")
    assert ids == [0, 1]
    assert robots.known == {"/a": 0, "/b": 1}


def test_the_129th_robot_gets_no_id():
    robots = Robots()
    assert register(robots, *(f"/r{number}" for number in ROBOT_IDS)) == list(range(128))
    assert register(robots, "/one_more", "/unnamed") == [None, None]
    assert register(robots, "/r5") == [5]


def test_a_kept_id_is_given_to_no_other():
    robots = Robots({"/away": 7})
    ids = register(robots, *(f"/r{number}" for number in range(127)))
    assert 7 not in ids
    assert register(robots, "/new", "/unnamed") == [None, None]
    assert register(robots, "/away") == [7]


def test_a_name_alone_is_not_remembered_and_displaces_nobody():
    robots = Robots({"/away": 7})
    for number in range(1000):
        robot_id, name = robots.id_for(f"/fake{number}")
        assert robot_id not in (None, 7)
        robots.put(robot_id, name, 0.0)
        robots.del_robot(robot_id)
    assert robots.known == {"/away": 7}


def test_available_robots_are_those_on_their_topics_without_user_lowest_first():
    robots = Robots()
    register(robots, "/a", "/b", "/c", "/d")
    robots.link(3, False)
    the(robots, 0).user = "ada"
    assert robots.get_available_robots() == [the(robots, 1), the(robots, 2)]
    for robot in robots:
        robot.user = "x"
    assert robots.get_available_robots() == []
