"""A tournament in the game: who gets a robot, who may fight, what a battle decides, and what is kept."""

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from server.game import changes, desk, tournament_desk
from server.game.events import from_json, kind_of, to_json
from server.game.referee import HOLD, Verdict
from server.game.rules import Rules
from server.game.state import State

FOUR = ["ada", "bob", "cy", "dee"]


def operate(match, wish: Callable[..., Any], **wanted: Any) -> None:
    match.referee.operate(partial(wish, by="Ann", **wanted), match.now)


def open_one(match, **options: Any) -> None:
    operate(match, tournament_desk.open_one, **{"names": FOUR, **options})


def call(match, number: int | None = None) -> None:
    operate(match, tournament_desk.call, number=number)


def queue_up(match, *names: str) -> None:
    for name in names:
        match.referee.sign_up(name, match.session(name), 0, match.now, wait=True)


def take(match, name: str) -> None:
    assert match.referee.take_offer(match.session(name), match.now)[0] is Verdict.OK


def set_ready(match, name: str) -> Verdict:
    return match.referee.set_ready(name, True, match.session(name), match.now)


def fight(match, winner: str, loser: str) -> None:
    match.ready(winner, loser)
    match.wait(15)
    match.hit(loser, 10)
    assert match.ranking[0] == (1, winner)


def seen(match) -> dict[str, Any]:
    return match.referee.overview(match.now)["tournament"]


def of_match(match, number: int) -> dict[str, Any]:
    return seen(match)["matches"][number - 1]


def told(match) -> list[str]:
    return [str(one.event) for one in match.referee.take_journal()]


def test_without_a_tournament_nobody_hears_of_one(match):
    assert match.state.tournament == 0
    assert seen(match) is None


def test_a_whole_tournament_by_the_referees_results(match):
    match.sign_up(*FOUR)
    open_one(match, third=True)
    for winner, loser in (("ada", "dee"), ("cy", "bob"), ("dee", "bob"), ("cy", "ada")):
        call(match)
        fight(match, winner, loser)
    assert [one["winner"] for one in seen(match)["matches"]] == ["ada", "cy", "dee", "cy"]
    assert seen(match)["champion"] == "cy"
    with pytest.raises(desk.RefusedError, match="no other match"):
        call(match)


def test_the_players_of_a_match_are_told_their_robots_and_others_cannot_fight_meanwhile(match):
    match.sign_up(*FOUR)
    open_one(match)
    match.ready("cy")
    call(match)
    assert (of_match(match, 1)["players"], of_match(match, 1)["robots"]) == (["ada", "dee"], [0, 3])
    assert not match.player("cy").ready
    assert set_ready(match, "cy") is Verdict.STARTED
    operate(match, desk.start)
    match.wait(0.5)
    assert [player.name for player in match.state.players if player.ready] == ["ada", "dee"]
    match.hit("dee", 10)
    assert of_match(match, 1)["winner"] == "ada"
    assert set_ready(match, "cy") is Verdict.OK


def test_whoever_is_called_gets_a_robot_before_those_who_wait(new_match):
    match = new_match(robots=2)
    match.sign_up("eve", "ada")
    queue_up(match, "fay", "dee")
    open_one(match)
    call(match)
    assert of_match(match, 1)["robots"] == [1, 0]
    assert [(one.name, one.offer) for one in match.state.queue] == [("eve", None), ("fay", None), ("dee", 0)]
    take(match, "dee")
    fight(match, "dee", "ada")
    assert of_match(match, 1)["winner"] == "dee"


def test_whoever_is_called_and_waits_is_offered_the_robot_as_long_as_the_operator_waits(new_match):
    match = new_match(robots=2)
    match.sign_up("eve", "fay")
    queue_up(match, "ada", "dee")
    open_one(match, patience=0)
    call(match)
    for _ in range(200):
        match.wait(0.4)
        for waiter in match.state.queue:
            match.referee.seen(waiter.session, match.now)
    offered = {waiter.name for waiter in match.state.queue if waiter.offer is not None}
    assert offered == {"ada", "dee"}, "after several offers that nobody took"


def test_a_robot_is_kept_for_somebody_who_has_not_signed_up_yet(new_match):
    match = new_match(robots=2)
    match.sign_up("ada")
    open_one(match)
    call(match)
    assert match.state.available_robots == 0
    queue_up(match, "eve")
    assert [(one.name, one.offer) for one in match.state.queue] == [("eve", None)]
    match.sign_up("Dee")
    assert match.player("Dee").robot == 1
    fight(match, "Dee", "ada")
    assert of_match(match, 1)["winner"] == "dee"


def test_a_match_has_neither_latecomers_nor_teams(new_match):
    match = new_match(rules=Rules(late_join=True, teams=2))
    match.sign_up(*FOUR)
    open_one(match)
    assert match.state.teams == 2
    call(match)
    assert match.state.teams == 0, "nobody is promised any"
    match.ready("ada", "dee")
    match.wait(15)
    assert match.state.game == 2
    assert not match.player("cy").may_join
    assert set_ready(match, "cy") is Verdict.STARTED
    assert {player.team for player in match.state.players} == {0}


def test_between_the_battles_of_a_match_nobody_loses_the_robot(new_match):
    match = new_match(robots=2, rules=Rules(battles_in_row=1, idle=30))
    match.sign_up("ada", "dee")
    open_one(match, best_of=3, patience=0)
    call(match)
    queue_up(match, "eve")
    fight(match, "ada", "dee")
    match.wait(60)
    fight(match, "dee", "ada")
    assert (of_match(match, 1)["wins"], of_match(match, 1)["winner"]) == ([1, 1], None)
    fight(match, "dee", "ada")
    assert (of_match(match, 1)["wins"], of_match(match, 1)["winner"]) == ([1, 2], "dee")
    assert [one.name for one in match.state.queue] != ["eve"], "after the match, the seats are for others again"


def test_a_draw_and_an_aborted_battle_decide_nothing(match):
    match.sign_up(*FOUR)
    open_one(match, patience=0)
    call(match)
    match.ready("ada", "dee")
    match.wait(15 + 301)
    assert match.ranking == [(1, "ada"), (1, "dee")]
    match.ready("ada", "dee")
    match.wait(15)
    match.hit("dee", 1)
    operate(match, desk.abort)
    assert (of_match(match, 1)["wins"], of_match(match, 1)["called"]) == ([0, 0], True)


def test_who_is_not_ready_in_time_loses_if_the_other_one_is(match):
    match.sign_up(*FOUR)
    open_one(match, patience=60)
    call(match)
    match.wait(100)
    assert of_match(match, 1)["winner"] is None, "where nobody is ready, the operator decides"
    match.ready("dee")
    match.wait(29)
    assert of_match(match, 1)["winner"] is None
    match.wait(2)
    assert (of_match(match, 1)["winner"], of_match(match, 1)["how"]) == ("dee", "no_show")
    assert "match 1: ada was not there, so dee has won" in told(match)


@pytest.mark.parametrize(("passed", "counts_after"), [(10, 50), (200, 30)], ids=["in time", "when the time is over"])
def test_while_battles_are_held_nobody_loses_for_not_being_ready(match, passed, counts_after):
    match.sign_up(*FOUR)
    open_one(match, patience=60)
    call(match)
    match.wait(passed)
    match.referee.restarting("", "", match.now, is_local=True)
    match.ready("dee")
    for _ in range(5):
        match.wait(9)
        match.referee.restarting("", "", match.now, is_local=True)
    assert of_match(match, 1)["winner"] is None
    match.wait(HOLD + counts_after - 1)
    assert of_match(match, 1)["winner"] is None
    match.wait(2)
    assert of_match(match, 1)["winner"] == "dee"


def test_the_operator_says_who_is_missing(match):
    open_one(match)
    operate(match, tournament_desk.no_show, number=1, name="ADA")
    assert of_match(match, 1)["winner"] == "dee"
    with pytest.raises(desk.UnknownError):
        operate(match, tournament_desk.no_show, number=2, name="ada")
    with pytest.raises(desk.UnknownError):
        operate(match, tournament_desk.no_show, number=3, name="dee")


def test_a_correction_is_logged_with_its_reason(match):
    open_one(match)
    operate(match, tournament_desk.no_show, number=1, name="ada")
    told(match)
    operate(match, tournament_desk.correct, number=1, winner="ada", reason="was at the wrong robot")
    assert told(match) == ["match 1 corrected: ada has won, since: was at the wrong robot (by Ann)"]
    assert (of_match(match, 1)["winner"], of_match(match, 1)["how"]) == ("ada", "corrected")
    with pytest.raises(ValueError, match="reason"):
        operate(match, tournament_desk.correct, number=1, winner="dee", reason=" ")


def test_a_closed_tournament_holds_nobody_up_and_is_shown_until_the_next(match):
    match.sign_up(*FOUR)
    open_one(match)
    call(match)
    operate(match, tournament_desk.close)
    assert match.state.tournament == 0
    assert set_ready(match, "cy") is Verdict.OK
    assert (seen(match)["open"], seen(match)["names"]) == (False, FOUR)
    version = seen(match)["version"]
    open_one(match, title="Second")
    assert seen(match)["version"] == version + 1


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"names": FOUR[:3]}, "4 to 64 players"),
        ({"names": [f"p{number}" for number in range(65)]}, "4 to 64 players"),
        ({"names": [*FOUR, "ADA"]}, "twice"),
        ({"names": [*FOUR, "<b>"]}, "no name"),
        ({"names": [*FOUR, 7]}, "no name"),
        ({"kind": "league"}, "kind"),
        ({"best_of": 2}, "best_of"),
        ({"patience": -1}, "patience"),
        ({"kind": "groups", "groups": 2}, "1 to 1 groups"),
        ({"title": "x" * 41}, "title"),
    ],
)
def test_what_cannot_be_opened_is_refused(match, options, why):
    with pytest.raises(ValueError, match=why):
        open_one(match, **options)
    assert seen(match) is None


def test_a_match_is_called_only_when_it_can_be_played(new_match):
    match = new_match(robots=1)
    with pytest.raises(desk.RefusedError, match="no tournament"):
        call(match)
    open_one(match)
    with pytest.raises(desk.RefusedError, match="already"):
        open_one(match)
    with pytest.raises(desk.RefusedError, match="two robots"):
        call(match)
    match.register("/another")
    with pytest.raises(desk.RefusedError, match="waits for its players"):
        call(match, 3)
    with pytest.raises(desk.UnknownError):
        call(match, 9)
    call(match, 2)
    assert of_match(match, 2)["called"]
    call(match)
    assert of_match(match, 1)["called"]
    assert not of_match(match, 2)["called"]
    match.sign_up("ada", "dee")
    match.ready("ada", "dee")
    with pytest.raises(desk.RefusedError, match="wait"):
        call(match)


def test_the_time_to_the_next_matches_is_estimated(match):
    open_one(match)
    assert [one["seconds"] for one in seen(match)["matches"]] == [0, 180, 360]


def test_all_of_it_goes_on_in_another_program(match):
    match.sign_up(*FOUR)
    open_one(match, best_of=3, patience=60)
    call(match)
    fight(match, "dee", "ada")
    before = seen(match)
    match.restart(pause=5)
    assert seen(match) == before
    match.ready("ada")
    match.wait(50)
    assert of_match(match, 1)["winner"] is None
    match.wait(10)
    assert of_match(match, 1)["winner"] == "ada", "the time to get ready has gone on meanwhile"


def test_it_follows_from_its_events(match):
    match.sign_up(*FOUR)
    open_one(match)
    call(match)
    fight(match, "dee", "ada")
    journal = match.referee.take_journal()
    kinds = [kind_of(one.event) for one in journal]
    assert kinds[-2:] == ["BattleEnded", "GameWon"]
    state = State()
    for at, event in ((one.at, one.event) for one in journal):
        changes.apply(state, from_json(kind_of(event), json.loads(json.dumps(to_json(event)))), at)
    assert state.tournament is not None
    assert state.tournament.result(state.tournament.matches[0]).winner == 4


def test_what_was_decided_before_holds_again_when_it_comes_to_light_late(match):
    open_one(match)
    operate(match, tournament_desk.no_show, number=1, name="ada")
    saved = json.loads(json.dumps(match.referee.saved(match.now)))
    match.restart(saved={**saved, "tournament": None})
    assert seen(match) is None
    match.referee.take_over(saved, {}, match.now)
    assert of_match(match, 1)["winner"] == "dee"
    operate(match, tournament_desk.close)
    match.referee.take_over(saved, {}, match.now)
    assert not seen(match)["open"], "what is newer stays"


def test_what_another_version_kept_of_a_tournament_does_not_stop_the_game(match):
    match.start("ada", "bob")
    saved = match.referee.saved(match.now) | {"tournament": {"kind": "league"}}
    match.restart(saved=saved)
    assert seen(match) is None
    assert match.state.game == 2
