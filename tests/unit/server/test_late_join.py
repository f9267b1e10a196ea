"""Who comes while a battle runs may join it, where the rule says so."""

from functools import partial

import pytest

from server.game import desk
from server.game.events import kind_of, to_json
from server.game.referee import Verdict
from server.game.replay import replay
from server.game.rules import Rules
from server.ros.status import to_message
from server.store.course import courses
from server.web.watch import public_status


@pytest.fixture
def running(new_match):
    """ada with life 100 and bob with 70 fight, cy has a robot, and dee comes later."""
    match = new_match(rules=Rules(late_join=True))
    match.start("ada", "bob")
    match.sign_up("cy")
    match.hit("bob", 3)
    return match


def join(match, name: str) -> Verdict:
    return match.referee.set_ready(name, True, match.session(name), match.now)


def test_without_the_rule_the_battle_is_closed(new_match):
    match = new_match()
    match.start("ada", "bob")
    match.sign_up("cy")
    assert not match.player("cy").may_join
    assert join(match, "cy") is Verdict.STARTED


def test_whoever_joins_has_the_life_of_the_weakest_who_is_alive(running):
    running.sign_up("dee")
    running.ready("dee")
    running.hit("dee", 10)
    assert join(running, "cy") is Verdict.OK
    assert (running.player("cy").ready, running.player("cy").life) == (True, 70)


def test_whoever_has_joined_fights_until_the_end(running):
    assert join(running, "cy") is Verdict.OK
    assert running.hit("cy") == [True]
    assert running.referee.shot(running.player("cy").robot, running.now)
    running.hit("bob", 7)
    assert running.state.game == 2, "there are two sides still"
    running.hit("ada", 10)
    assert running.ranking == [(1, "cy"), (2, "ada"), (3, "bob")]


def test_it_is_told_whether_one_may_join(running):
    told = {one["name"]: one["may_join"] for one in public_status(running.state)["users"]}
    assert told == {"ada": False, "bob": False, "cy": True}
    assert {one.name for one in to_message(running.state).users if one.may_join} == {"cy"}
    running.sign_out("bob")
    assert not running.player("cy").may_join, "no battle runs"


def test_who_is_out_does_not_come_back(running):
    join(running, "cy")
    running.hit("cy", 7)
    assert running.player("cy").life == 0
    assert join(running, "cy") is Verdict.STARTED
    assert running.player("cy").life == 0


@pytest.mark.parametrize("name", ["bob", "eve"])
def test_who_has_left_comes_back_neither_by_name_nor_with_the_same_robot(running, name):
    join(running, "cy")
    running.sign_out("bob")
    if name == "bob":
        running.referee.sign_up(name, running.session(name), 0, running.now, wanted=3)
        assert running.player("bob").robot == 3
    else:
        running.sign_up("eve")
        assert running.player("eve").robot == 1, "bob's"
    assert not running.player(name).may_join
    assert join(running, name) is Verdict.STARTED


def test_whose_robot_is_away_does_not_join(running):
    running.wait(4, dead_robots=(2,))
    assert running.player("cy").robot == 2
    assert not running.player("cy").may_join
    assert join(running, "cy") is Verdict.STARTED


def test_only_the_own_session_joins_and_nobody_leaves_by_it(running):
    assert running.referee.set_ready("cy", True, running.session("bob"), running.now) is Verdict.STARTED
    assert running.referee.set_ready("ada", False, running.session("ada"), running.now) is Verdict.STARTED
    assert running.player("ada").ready
    assert not running.player("cy").ready


def test_nobody_joins_in_a_pause(running):
    running.referee.operate(partial(desk.pause, by="Ann"), running.now)
    assert not running.player("cy").may_join
    assert join(running, "cy") is Verdict.STARTED


def test_nobody_joins_a_battle_of_teams(new_match):
    match = new_match(rules=Rules(late_join=True, teams=2))
    match.start("ada", "bob")
    match.sign_up("cy")
    assert not match.player("cy").may_join
    assert join(match, "cy") is Verdict.STARTED


def test_the_handicap_holds_for_late_comers(new_match):
    match = new_match(rules=Rules(late_join=True, handicap=30))
    match.sign_up("ada", "bob", "cy")
    for _ in range(3):
        match.ready("ada", "cy")
        match.wait(15)
        match.hit("cy", 15)
        assert match.state.game == 0
    match.ready("ada", "bob")
    match.wait(15)
    assert join(match, "cy") is Verdict.OK
    match.hit("cy")
    assert match.player("cy").life == 93


def test_a_battle_that_was_joined_is_kept_and_played_again(running):
    running.wait(10)
    join(running, "cy")
    running.restart()
    assert running.player("cy").life == 70


def test_its_events_lead_to_its_result_and_to_the_course_of_each(running):
    running.wait(10)
    join(running, "cy")
    running.hit("cy", 2)
    running.hit("ada", 10)
    running.hit("bob", 7)
    journal = running.referee.take_journal()
    assert replay(journal) == running.state.result
    assert running.ranking == [(1, "cy"), (2, "bob"), (3, "ada")]
    by_name = {one.name: one for one in courses((one.at, kind_of(one.event), to_json(one.event)) for one in journal)}
    assert by_name["cy"].joined == pytest.approx(10.3)
    assert [by_name["cy"].first, *(change.life for change in by_name["cy"].changes)] == [70, 60, 50]
    assert by_name["ada"].joined == 0
