"""The start of a battle, in which nobody can be hit."""

from functools import partial

import pytest

from server.game import desk
from server.game.rules import Rules


@pytest.fixture
def safe(new_match):
    """A battle of ada and bob that has just begun; for 3 s nobody can be hit."""
    match = new_match(protection=3)
    match.start("ada", "bob")
    return match


def test_nobody_can_be_hit_at_the_start_of_a_battle(safe):
    safe.wait(2.8)
    assert safe.hit("bob") == [False]
    assert (safe.player("bob").life, safe.state.happened) == (100, ())
    safe.wait(0.1)
    assert safe.hit("bob") == [True]


def test_without_the_rule_everybody_can_be_hit_at_once(new_match):
    match = new_match(protection=0)
    match.start("ada", "bob")
    assert match.state.protection == 0
    assert match.hit("bob") == [True]


def test_the_rule_is_three_seconds_unless_chosen():
    assert Rules().protection == 3


@pytest.mark.parametrize("light", ["plain", "coded"])
def test_a_shot_that_met_somebody_then_counts_for_nobody_and_does_not_hit_later(new_match, light):
    match = new_match(rules=Rules(light=light), protection=3)
    match.start("ada", "bob")

    def meets_bob() -> bool:
        if light == "coded":
            return match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)
        return match.referee.hit(1, match.now, shots_told=True)

    match.wait(2.7)
    assert match.referee.shot(0, match.now)
    match.wait(0.2)
    assert not meets_bob()
    match.wait(0.2)
    assert not meets_bob(), "the same shot's light"
    assert (match.player("bob").life, match.player("ada").hits) == (100, 0)
    match.wait(1.0)
    assert match.referee.shot(0, match.now)
    assert meets_bob()
    assert match.player("ada").hits == 1


def test_how_long_it_still_lasts_is_told_in_a_battle_only(new_match):
    match = new_match(protection=3)
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    assert match.state.protection == 0
    match.wait(15)
    assert match.state.protection == pytest.approx(3)
    match.wait(1)
    assert match.state.protection == pytest.approx(2)
    match.sign_out("bob")
    assert match.state.protection == 0


def test_it_is_told_that_it_is_over(safe):
    safe.wait(4)
    assert safe.state.protection == 0


def test_it_does_not_run_out_in_a_pause(safe):
    safe.wait(1)
    safe.referee.operate(partial(desk.pause, by="Ann"), safe.now)
    safe.wait(60)
    assert safe.state.protection == pytest.approx(2)
    safe.referee.operate(partial(desk.resume, by="Ann"), safe.now)
    safe.wait(1.8)
    assert safe.hit("bob") == [False]
    safe.wait(0.2)
    assert safe.hit("bob") == [True]


@pytest.mark.parametrize("paused", [False, True])
def test_it_outlives_the_program(safe, paused):
    if paused:
        safe.referee.operate(partial(desk.pause, by="Ann"), safe.now)
    safe.restart(pause=1)
    assert safe.state.protection == pytest.approx(3 if paused else 2)


def test_an_older_programs_battle_has_none(safe):
    saved = safe.referee.saved(safe.now)
    del saved["protected"]
    safe.restart(saved=saved)
    assert safe.hit("bob") == [True]


def test_another_value_is_for_the_next_battle(safe):
    safe.referee.operate(partial(desk.change_rules, by="Ann", changes={"protection": 0}), safe.now)
    assert safe.hit("bob") == [False]
