"""Streaks and revenge: what the referee tells about a shooter besides the hit."""

import json
from functools import partial

import pytest

from server.game import desk
from server.game.rivalry import Winning, follow
from server.game.rules import Rules
from server.game.snapshot import Placing
from server.ros.status import to_message
from server.web.watch import public_status


@pytest.fixture
def match(new_match):
    """Coded light, in which one hit takes a robot out."""
    match = new_match(rules=Rules(light="coded", hit_damage=100))
    match.sign_up("ada", "bob", "cy")
    return match


def battle(match, *hits: tuple[str, str]) -> None:
    """In which each of these, (victim, shooter), takes somebody out; all who are left win."""
    match.ready("ada", "bob", "cy")
    match.wait(15)
    assert match.state.game == 2
    for victim, shooter in hits:
        match.wait(1)
        assert match.referee.shot_hit(match.player(victim).robot, match.player(shooter).robot, 0, match.now)
    if match.state.game == 2:
        match.wait(match.rules.battle_limit)


def told(match) -> list[tuple[str, str, int, bool]]:
    return [(one.name, one.by, one.streak, one.revenge) for one in match.state.happened]


def test_a_streak_is_what_somebody_has_taken_out_in_this_battle(match):
    battle(match, ("bob", "ada"), ("cy", "ada"))
    assert told(match) == [("bob", "ada", 1, False), ("cy", "ada", 2, False)]
    battle(match, ("bob", "ada"))
    assert told(match) == [("bob", "ada", 1, False)]


def test_a_hit_that_leaves_some_life_is_neither(new_match):
    match = new_match(rules=Rules(light="coded", hit_damage=50))
    match.start("ada", "bob")
    match.referee.shot_hit(0, 1, 0, match.now)
    assert told(match) == [("ada", "bob", 0, False)]


def test_revenge_is_on_whoever_was_the_last_to_take_somebody_out_and_once_only(match):
    battle(match, ("ada", "bob"))
    battle(match, ("ada", "cy"))
    battle(match, ("bob", "ada"))
    assert told(match) == [("bob", "ada", 1, False)], "cy was the last"
    battle(match, ("cy", "ada"))
    assert told(match) == [("cy", "ada", 1, True)]
    battle(match, ("cy", "ada"))
    assert told(match) == [("cy", "ada", 1, False)]


def test_wins_in_a_row_are_counted_until_one_is_not_won(match):
    battle(match, ("cy", "ada"))
    battle(match, ("bob", "ada"), ("cy", "ada"))
    assert {placing.name: placing.wins for placing in match.state.result} == {"ada": 2, "bob": 0, "cy": 0}
    battle(match, ("ada", "bob"), ("cy", "bob"))
    assert {placing.name: placing.wins for placing in match.state.result} == {"ada": 0, "bob": 1, "cy": 0}


def test_an_aborted_battle_changes_nothing(match):
    battle(match, ("bob", "ada"), ("cy", "ada"))
    match.ready("ada", "bob", "cy")
    match.wait(15)
    match.referee.operate(partial(desk.abort, by="Ann"), match.now)
    battle(match, ("bob", "ada"), ("cy", "ada"))
    assert match.placing("ada").wins == 2


def test_whoever_leaves_before_the_end_has_not_won() -> None:
    winner = Placing("ada", 0, 100, 0, 1, left=True)
    assert follow([Winning("ada", 3)], [winner]) == ()


def test_a_program_that_starts_again_knows_both(match):
    battle(match, ("ada", "bob"), ("cy", "bob"))
    match.restart()
    match.wait(1)
    battle(match, ("cy", "bob"), ("ada", "bob"))
    assert match.placing("bob").wins == 2
    match.restart()
    match.wait(1)
    battle(match, ("bob", "ada"))
    assert told(match) == [("bob", "ada", 1, True)]


def test_everybody_hears_of_them(match):
    battle(match, ("bob", "ada"), ("cy", "ada"))
    battle(match, ("ada", "bob"), ("cy", "bob"))
    state = match.state
    message, text = to_message(state), json.loads(json.dumps(public_status(state)))
    assert [(one.streak, one.revenge) for one in message.events] == [(1, True), (2, False)]
    assert [(one["streak"], one["revenge"]) for one in text["events"]] == [(1, True), (2, False)]
    assert [one.wins for one in message.result] == [one["wins"] for one in text["result"]] == [1, 0, 0]


def test_whoever_leaves_has_neither_any_more(match):
    battle(match, ("ada", "bob"), ("cy", "bob"))
    match.sign_out("bob")
    saved = match.referee.saved(match.now)
    assert (saved["winning"], saved["grudges"]) == ([], [])
    match.sign_up("bob")
    battle(match, ("bob", "ada"), ("cy", "ada"))
    assert told(match) == [("bob", "ada", 1, False), ("cy", "ada", 2, False)]
