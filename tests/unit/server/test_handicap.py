"""Who has lost three battles in a row takes less damage, where the rule says so."""

import json

import pytest

from laser_bot_battle.light_protocol import DAMAGES
from server.game.events import BattleStarted, RulesChanged
from server.game.handicap import IN_A_ROW, REMEMBERED, Losing, damage_with, follow
from server.game.rules import Rules
from server.game.snapshot import Placing
from server.ros.status import to_message
from server.web.watch import public_status


def battle(match, loser: str, *others: str) -> None:
    """In which all others survive the loser, with the life that is left to them."""
    for name in (loser, *others):
        if name not in match.names:
            match.sign_up(name)
    match.ready(loser, *others)
    match.wait(15)
    assert match.state.game == 2
    while match.state.game == 2:
        match.hit(loser)


@pytest.fixture
def unlucky(new_match):
    """ada has lost three battles in a row against bob."""
    match = new_match(rules=Rules(handicap=30))
    for _ in range(3):
        battle(match, "ada", "bob")
    return match


def start(match) -> None:
    match.ready("ada", "bob")
    match.wait(15)


def test_nobody_has_one_unless_it_is_chosen(new_match):
    match = new_match()
    for _ in range(4):
        battle(match, "ada", "bob")
    start(match)
    match.hit("ada")
    assert (match.player("ada").life, match.player("ada").handicap) == (90, 0)


def test_whoever_has_lost_three_battles_in_a_row_takes_less_damage(unlucky):
    start(unlucky)
    unlucky.hit("ada")
    unlucky.hit("bob")
    assert (unlucky.player("ada").life, unlucky.player("bob").life) == (93, 90)


def test_two_lost_battles_are_not_enough(new_match):
    match = new_match(rules=Rules(handicap=30))
    for _ in range(2):
        battle(match, "ada", "bob")
    start(match)
    match.hit("ada")
    assert match.player("ada").life == 90


def test_coded_light_is_weaker_too(new_match):
    match = new_match(rules=Rules(handicap=50, light="coded", light_damage=True))
    match.sign_up("ada", "bob")

    def hit_ada() -> None:
        match.wait(1)
        assert match.referee.shot_hit(0, 1, DAMAGES.index(50), match.now)

    for _ in range(3):
        start(match)
        hit_ada()
        hit_ada()
    start(match)
    hit_ada()
    assert match.player("ada").life == 75


def test_to_win_ends_it(unlucky):
    battle(unlucky, "bob", "ada")
    assert unlucky.player("ada").handicap == 0


def test_it_stays_as_long_as_nothing_is_won_and_outlives_leaving_and_restarts(unlucky):
    battle(unlucky, "ada", "bob")
    unlucky.sign_out("ada")
    unlucky.restart()
    unlucky.sign_up("ada")
    assert unlucky.player("ada").handicap == 30


def test_a_running_battles_one_outlives_a_restart(unlucky):
    start(unlucky)
    unlucky.restart()
    unlucky.hit("ada")
    assert unlucky.player("ada").life == 93


def test_everybody_is_told_before_the_battle_and_in_it(unlucky):
    wanted = {"ada": 30, "bob": 0}

    def is_told() -> bool:
        public = {user["name"]: user["handicap"] for user in public_status(unlucky.state)["users"]}
        return public == {user.name: user.handicap for user in to_message(unlucky.state).users} == wanted

    assert is_told()
    start(unlucky)
    assert is_told()
    started = [one.event for one in unlucky.referee.take_journal() if isinstance(one.event, BattleStarted)][-1]
    assert {fighter.name: fighter.handicap for fighter in started.fighters} == wanted


def test_another_value_is_for_the_next_battle(unlucky):
    start(unlucky)
    unlucky.referee.operate(lambda *_: [RulesChanged({"handicap": 0}, "Ann")], unlucky.now)
    unlucky.hit("ada")
    assert unlucky.player("ada").life == 93


def test_what_an_older_program_has_saved_is_read(unlucky):
    start(unlucky)
    saved = json.loads(json.dumps(unlucky.referee.saved(unlucky.now)))
    del saved["losing"]
    for user in saved["users"]:
        del user["handicap"]
    unlucky.restart(saved=saved)
    assert unlucky.player("ada").handicap == 0


# who is losing


def result(**places: int) -> list[Placing]:
    return [Placing(name, 0, 0, 0, place, left=False) for name, place in places.items()]


def test_a_draw_is_not_lost_and_a_shared_second_place_is():
    assert follow((), result(ada=1, bob=1)) == ()
    assert follow((), result(ada=1, bob=2, cy=2)) == (Losing("bob", 1), Losing("cy", 1))


def test_who_leaves_has_neither_lost_nor_won():
    left = Placing("ada", 0, 0, 0, 2, left=True)
    assert follow((), [left]) == ()
    assert follow((Losing("ada", 2),), [left]) == (Losing("ada", 2),)


def test_bots_have_none():
    assert follow((), result(Bot1=2, ada=1)) == ()


def test_only_the_latest_are_remembered():
    many = tuple(Losing(f"p{number}", 1) for number in range(REMEMBERED))
    after = follow(many, result(ada=2, p0=2))
    assert len(after) == REMEMBERED
    assert after[-2:] == (Losing("ada", 1), Losing("p0", 2))
    assert IN_A_ROW == 3, "as the rule's text says"


def test_every_hit_takes_something():
    assert [damage_with(percent, 10) for percent in (0, 25, 90)] == [10, 8, 1]
    assert damage_with(90, 1) == 1
