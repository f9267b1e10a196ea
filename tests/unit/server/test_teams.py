"""Teams: who is in which, when one has won, and who may shoot at whom."""

import pytest

from server.game.referee import Verdict
from server.game.replay import replay
from server.game.rules import Rules
from tests.unit.server.conftest import Match


@pytest.fixture
def new_teams(new_match):
    def make(teams: int = 2, robots: int = 6, **rules) -> Match:
        return new_match(robots=robots, rules=Rules(teams=teams, **rules))

    return make


def choose(match: Match, name: str, team: int) -> Verdict:
    return match.referee.choose_team(name, team, match.session(name), match.now)


def teams(match: Match) -> dict[str, int]:
    return {player.name: player.team for player in match.state.players}


def test_everybody_fights_alone_unless_there_are_teams(match):
    match.sign_up("ada")
    assert choose(match, "ada", 1) is Verdict.NO_TEAM
    assert choose(match, "ada", 0) is Verdict.OK
    match.start("bob", "cy")
    assert match.state.teams == 0
    assert set(teams(match).values()) == {0}


def test_who_chooses_nothing_is_dealt_to_the_smallest_team(new_teams):
    match = new_teams()
    match.start("ada", "bob", "cy", "dee", "eve")
    assert sorted(teams(match).values()) == [1, 1, 1, 2, 2]
    assert match.state.teams == 2


def test_a_choice_holds_for_this_battle_and_the_next(new_teams):
    match = new_teams(3)
    match.sign_up("ada", "bob", "cy", "dee")
    assert choose(match, "ada", 3) is Verdict.OK
    assert choose(match, "bob", 3) is Verdict.OK
    assert teams(match) == {"ada": 3, "bob": 3, "cy": 0, "dee": 0}
    match.ready("ada", "bob", "cy", "dee")
    match.wait(15)
    assert teams(match) == {"ada": 3, "bob": 3, "cy": 1, "dee": 2}
    match.hit("cy", 10)
    match.hit("dee", 10)
    assert match.state.game == 0
    assert teams(match) == {"ada": 3, "bob": 3, "cy": 0, "dee": 0}


def test_who_may_choose_what_and_when(new_teams):
    match = new_teams()
    match.sign_up("ada", "bob")
    assert choose(match, "ada", 3) is Verdict.NO_TEAM
    assert choose(match, "ada", -1) is Verdict.NO_TEAM
    assert choose(match, "eve", 1) is Verdict.UNKNOWN_USER
    assert match.referee.choose_team("ada", 1, "another session", match.now) is Verdict.NOT_YOURS
    match.ready("ada", "bob")
    assert choose(match, "ada", 2) is Verdict.OK, "in the countdown"
    match.wait(15)
    assert choose(match, "ada", 1) is Verdict.STARTED
    assert teams(match) == {"ada": 2, "bob": 1}


def test_when_all_choose_the_same_team_the_referee_deals(new_teams):
    match = new_teams()
    match.sign_up("ada", "bob", "cy")
    for name in ("ada", "bob", "cy"):
        choose(match, name, 2)
    match.ready("ada", "bob", "cy")
    match.wait(15)
    assert sorted(teams(match).values()) == [1, 1, 2]


def test_fewer_teams_forget_the_choice_of_others(new_match):
    match = new_match(rules=Rules(teams=4))
    match.sign_up("ada", "bob")
    choose(match, "ada", 4)
    match.rules = Rules(teams=2)
    match.restart()
    assert teams(match) == {"ada": 0, "bob": 0}
    match.ready("ada", "bob")
    match.wait(15)
    assert teams(match) == {"ada": 1, "bob": 2}


@pytest.fixture
def four(new_teams) -> Match:
    """ada and bob against cy and dee."""
    match = new_teams(robots=4, light="coded")
    match.sign_up("ada", "bob", "cy", "dee")
    for name, team in (("ada", 1), ("bob", 1), ("cy", 2), ("dee", 2)):
        choose(match, name, team)
    match.ready("ada", "bob", "cy", "dee")
    match.wait(15)
    return match


def shoot(match: Match, shooter: str, victim: str, times: int = 1) -> list[bool]:
    counted = []
    for _ in range(times):
        match.wait(0.5)
        robots = match.player(victim).robot, match.player(shooter).robot
        match.referee.shot(robots[1], match.now)
        counted.append(match.referee.shot_hit(*robots, 0, match.now, shots_told=True))
    return counted


def test_a_team_wins_when_no_other_lives_and_shares_the_first_place(four):
    shoot(four, "cy", "ada", 10)
    shoot(four, "bob", "cy", 10)
    assert four.state.game == 2
    shoot(four, "bob", "dee", 10)
    assert four.ranking == [(1, "bob"), (1, "ada"), (3, "dee"), (3, "cy")]
    assert four.placing("bob").kills == 2
    assert four.placing("dee").team == 2
    assert replay(four.referee.take_journal()) == four.state.result
    assert four.names == ["bob", "ada", "dee", "cy"]


def test_friendly_fire_is_a_rule(four, new_teams):
    assert shoot(four, "ada", "bob") == [False]
    assert shoot(four, "ada", "cy") == [True]
    match = new_teams(robots=3, light="coded", friendly_fire=True)
    match.sign_up("ada", "bob", "cy")
    for name, team in (("ada", 1), ("bob", 1), ("cy", 2)):
        choose(match, name, team)
    match.ready("ada", "bob", "cy")
    match.wait(15)
    assert shoot(match, "ada", "bob", 10) == [True] * 10
    match.now += 0.2
    assert (match.player("ada").hits, match.player("ada").kills) == (0, 0), "nothing to be proud of"
    assert match.state.happened[-1].by == "ada"


def test_plain_light_of_the_own_team_does_not_count_either(new_teams):
    match = new_teams(robots=3)
    match.sign_up("ada", "bob", "cy")
    for name, team in (("ada", 1), ("bob", 1), ("cy", 2)):
        choose(match, name, team)
    match.ready("ada", "bob", "cy")
    match.wait(15)
    match.referee.shot(0, match.now)
    assert not match.referee.hit(1, match.now, shots_told=True)
    assert match.referee.hit(2, match.now, shots_told=True)


def test_at_the_time_limit_the_team_with_more_life_wins(four):
    shoot(four, "cy", "ada", 9)
    shoot(four, "ada", "dee", 2)
    shoot(four, "bob", "cy", 1)
    four.wait(four.state.time_left)
    assert four.ranking == [(1, "cy"), (1, "dee"), (3, "bob"), (3, "ada")]


def test_who_has_left_stands_behind_all_teams(four):
    four.sign_out("bob")
    four.wait(1)
    shoot(four, "cy", "ada", 10)
    assert four.ranking == [(1, "cy"), (1, "dee"), (3, "ada"), (4, "bob")]


def test_of_the_teams_that_are_out_the_one_that_fell_last_is_the_best(new_teams):
    match = new_teams(teams=3)
    match.start("ada", "bob", "cy")
    assert teams(match) == {"ada": 1, "bob": 2, "cy": 3}
    match.hit("bob", 10)
    match.wait(1)
    match.hit("cy", 10)
    assert match.ranking == [(1, "ada"), (2, "cy"), (3, "bob")]


def test_a_battle_goes_on_in_its_teams_whatever_the_rules_say_meanwhile(four):
    four.rules = Rules(light="coded")
    four.restart()
    assert four.state.teams == 2
    assert shoot(four, "ada", "bob") == [False]
    shoot(four, "ada", "cy", 10)
    shoot(four, "ada", "dee", 10)
    assert [place for place, _ in four.ranking] == [1, 1, 3, 3]
    assert four.state.teams == 0
