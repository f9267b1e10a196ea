"""What operators decide and what follows from it, by the rules."""

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from server.game import desk, events, tournament_desk
from server.game.events import BattleEnded, Recorded, kind_of, to_json
from server.game.referee import Referee, Verdict
from server.game.replay import replay
from server.game.rules import DECLARED, Rules
from server.store.course import courses


def operate(match, wish: Callable[..., Any], **wanted: Any) -> None:
    match.referee.operate(partial(wish, by="Ann", **wanted), match.now)


def join(match, *names: str) -> None:
    for name in names:
        match.referee.sign_up(name, match.session(name), 0, match.now, wait=True)


def queue(match) -> list[tuple[str, int | None]]:
    return [(waiter.name, waiter.offer) for waiter in match.state.queue]


def take(match, name: str) -> Verdict:
    return match.referee.take_offer(match.session(name), match.now)[0]


# bots


def for_bots(match) -> dict[int, str]:
    return match.referee.bots()


def test_a_robot_is_for_bots_as_configured_until_an_operator_decides(new_match):
    match = new_match(robots=4, rules=Rules(bots={2: "easy", 3: "easy"}))
    assert for_bots(match) == {2: "easy", 3: "easy"}
    operate(match, desk.give_to_bot, robot_id=3, level=None)
    operate(match, desk.give_to_bot, robot_id=2, level="hard")
    operate(match, desk.give_to_bot, robot_id=0, level="fair")
    assert for_bots(match) == {2: "hard", 0: "fair"}
    assert [robot["bot"] for robot in match.referee.overview(match.now)["robots"]] == ["fair", None, "hard", None]
    match.restart()
    assert for_bots(match) == {2: "hard", 0: "fair"}


def test_a_robot_that_is_taken_back_loses_its_bot_at_once_but_no_person(match):
    operate(match, desk.give_to_bot, robot_id=0, level="easy")
    operate(match, desk.give_to_bot, robot_id=1, level="easy")
    match.sign_up("Bot1", "ada")
    operate(match, desk.give_to_bot, robot_id=0, level="hard")
    assert {player.name for player in match.state.players} == {"Bot1", "ada"}, "another level is for the same bot"
    operate(match, desk.give_to_bot, robot_id=0, level=None)
    operate(match, desk.give_to_bot, robot_id=1, level=None)
    assert [player.name for player in match.state.players] == ["ada"]
    texts = [str(recorded.event) for recorded in match.referee.take_journal()]
    assert texts[-3:] == [
        "robot 0 is for people only (by Ann)",
        "Bot1 was signed out by the operator (by Ann)",
        "robot 1 is for people only (by Ann)",
    ]


def test_a_person_who_waits_gets_a_bots_robot_also_when_it_was_given_by_the_operator(new_match):
    match = new_match(robots=2)
    for robot in (0, 1):
        operate(match, desk.give_to_bot, robot_id=robot, level="easy")
    match.sign_up("Bot1", "Bot2")
    join(match, "ada")
    assert queue(match) == [("ada", 1)]
    assert [player.name for player in match.state.players] == ["Bot1"]
    assert for_bots(match) == {0: "easy", 1: "easy"}, "the bot may come back when nobody wants the robot"


def test_what_is_no_robot_or_no_level_is_for_no_bot(match):
    with pytest.raises(desk.UnknownError, match="there is no robot 9"):
        operate(match, desk.give_to_bot, robot_id=9, level="easy")
    with pytest.raises(ValueError, match="bot must be one of easy, fair, hard, or null"):
        operate(match, desk.give_to_bot, robot_id=0, level="")
    assert for_bots(match) == {}


# pause


def test_while_a_battle_is_paused_the_clock_stands_and_no_hit_counts(match):
    match.start("ada", "bob")
    match.wait(100)
    operate(match, desk.pause)
    assert match.state.paused
    match.wait(1000)
    assert match.state.time_left == pytest.approx(200)
    assert match.hit("bob") == [False]
    operate(match, desk.resume)
    assert match.hit("bob") == [True]
    match.wait(199)
    assert match.state.game == 2
    match.wait(2)
    assert match.state.notice == "Battle over: the time limit is reached."


def test_a_paused_countdown_does_not_end(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.wait(5)
    operate(match, desk.pause)
    match.wait(60)
    assert (match.state.game, match.state.time_left) == (1, pytest.approx(10))
    operate(match, desk.resume)
    match.wait(10)
    assert match.state.game == 2


def test_robots_and_pages_may_fall_silent_in_a_pause_and_the_battle_ends_by_it(match):
    match.start("ada", "bob", "cy")
    operate(match, desk.pause)
    match.wait(4, dead_robots=(0,))
    match.wait(16, gone_pages=("bob",))
    assert (match.state.game, match.state.paused) == (0, False)
    assert match.ranking == [(1, "cy"), (2, "bob"), (3, "ada")]


def test_the_next_battle_is_not_paused(match):
    match.start("ada", "bob")
    operate(match, desk.pause)
    operate(match, desk.abort)
    match.ready("ada", "bob")
    match.wait(15)
    assert (match.state.game, match.state.paused) == (2, False)


# abort and start


def test_an_aborted_battle_has_no_winner_and_does_not_begin_again(match):
    match.start("ada", "bob")
    match.hit("bob", 3)
    operate(match, desk.abort)
    match.wait(60)
    state = match.state
    assert (state.game, state.result, [player.ready for player in state.players]) == (0, (), [False, False])
    assert state.notice == "Battle over: the operator has ended it."
    (ended,) = [one.event for one in match.referee.take_journal() if isinstance(one.event, BattleEnded)]
    assert (ended.counts, ended.by, [placing.name for placing in ended.result]) == (False, "Ann", ["ada", "bob"])


def test_an_aborted_battle_is_none_of_those_in_a_row(new_match):
    match = new_match(robots=2, rules=Rules(battles_in_row=1))
    join(match, "ada", "bob", "cy")
    match.ready("ada", "bob")
    match.wait(15)
    operate(match, desk.abort)
    assert match.names == ["ada", "bob"]


def test_an_aborted_countdown_does_not_begin_again_by_itself(match):
    match.sign_up("ada", "bob", "cy")
    match.ready("ada", "bob")
    operate(match, desk.abort)
    match.wait(60)
    assert (match.state.game, match.state.notice) == (0, "Countdown stopped: the operator has ended it.")
    match.ready("ada")
    assert match.state.game == 0
    match.ready("bob")
    assert match.state.game == 1


def test_start_begins_the_battle_of_all_who_are_ready(match):
    match.sign_up("ada", "bob", "cy")
    match.ready("ada", "bob")
    operate(match, desk.start)
    assert (match.state.game, match.state.battle, match.state.time_left) == (2, 1, 300)
    assert match.hit("cy") == [False]
    assert match.hit("ada") == [True]


def test_start_takes_everybody_with_a_robot_when_nobody_is_ready(match):
    match.start("ada", "bob", "cy")
    match.hit("ada", 3)
    operate(match, desk.abort)
    operate(match, desk.start)
    assert (match.state.game, match.state.battle, match.state.time_left) == (2, 2, pytest.approx(300))
    assert [(player.ready, player.life) for player in match.state.players] == [(True, 100)] * 3
    assert any(str(recorded.event).endswith("(by Ann)") for recorded in match.referee.take_journal()[-2:])
    with pytest.raises(desk.RefusedError, match="running already"):
        operate(match, desk.start)


def test_start_leaves_out_whose_robot_is_away(new_match):
    match = new_match(robots=3)
    match.sign_up("ada", "bob", "cy")
    match.ready("cy")
    match.wait(5, dead_robots=(2,))
    operate(match, desk.start)
    assert {player.name for player in match.state.players if player.ready} == {"ada", "bob"}


def test_with_fewer_than_two_robots_nothing_starts(match):
    match.sign_up("ada")
    match.ready("ada")
    before = match.state
    with pytest.raises(desk.RefusedError, match="two players with robots"):
        operate(match, desk.start)
    assert match.state == before


def test_why_nothing_can_be_started_is_told_before_anybody_tries(match):
    def why() -> str:
        return match.referee.overview(match.now)["game"]["why_no_start"]

    match.sign_up("ada")
    assert why() == "too_few"
    match.sign_up("bob", "cy")
    assert why() == ""
    operate(match, tournament_desk.open_one, names=["cy", "dee", "eve", "fay"])
    operate(match, tournament_desk.call, number=None)
    assert why() == "match", "two who have robots are not in it"
    with pytest.raises(desk.RefusedError, match="both of its players"):
        operate(match, desk.start)


def test_a_countdown_that_is_paused_can_be_cut_short(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    operate(match, desk.pause)
    assert match.referee.overview(match.now)["game"]["why_no_start"] == ""
    operate(match, desk.start)
    assert (match.state.game, match.state.paused) == (2, False)
    assert match.referee.overview(match.now)["game"]["why_no_start"] == "runs"


@pytest.mark.parametrize("leaves", [False, True], ids=["stays", "leaves in the pause"])
def test_a_pause_is_no_time_in_which_anybody_has_fought(match, leaves):
    match.start("ada", "bob", "cy", "dee")
    match.hit("dee", 10)
    match.wait(3)
    operate(match, desk.pause)
    match.wait(20)
    if leaves:
        match.sign_out("cy")
    match.wait(20)
    operate(match, desk.resume)
    match.wait(4)
    match.hit("bob", 10)
    if not leaves:
        match.hit("cy", 10)
    journal = match.referee.take_journal()
    began = next(one.at for one in journal if isinstance(one.event, events.BattleStarted))
    by_name = {one.name: one for one in courses((one.at, kind_of(one.event), to_json(one.event)) for one in journal)}
    for name, seconds in {"dee": 1, "cy": 4 if leaves else 10, "bob": 9, "ada": 9 if leaves else 10}.items():
        assert match.placing(name).seconds == pytest.approx(seconds, abs=0.5)
        assert by_name[name].fought(journal[-1].at - began) == pytest.approx(seconds, abs=0.5)


def test_nor_is_one_in_which_the_program_was_restarted(match):
    match.start("ada", "bob")
    match.wait(10)
    operate(match, desk.pause)
    match.wait(20)
    match.restart(pause=5.0)
    match.wait(20)
    operate(match, desk.resume)
    match.wait(10)
    match.hit("bob", 10)
    assert match.placing("ada").seconds == pytest.approx(21, abs=0.5)
    assert match.referee.saved(match.now)["lengths"] == pytest.approx([21], abs=0.5)


def test_a_battle_that_ends_in_a_pause_is_not_longer_by_it(match):
    match.start("ada", "bob")
    match.wait(10)
    operate(match, desk.pause)
    match.wait(50)
    match.sign_out("bob")
    assert match.state.game == 0
    assert match.referee.saved(match.now)["lengths"] == pytest.approx([10], abs=0.5)


# rules


def test_a_rule_holds_from_now_on_and_a_running_battle_keeps_its_limit(match):
    match.start("ada", "bob")
    operate(match, desk.change_rules, changes={"hit_damage": 30, "battle_limit": 60, "countdown": 3})
    match.hit("bob")
    assert match.player("bob").life == 70
    match.wait(299)
    assert match.state.game == 2
    match.wait(2)
    match.ready("ada", "bob")
    match.wait(3)
    assert (match.state.game, match.state.time_left) == (2, pytest.approx(60))


def test_every_rule_has_a_variable_with_the_rules_own_default():
    assert {name: variable.default for name, variable in DECLARED.items()} == {
        name: getattr(Rules(), name) for name in DECLARED
    }


@pytest.mark.parametrize("name", [name for name, rule in DECLARED.items() if not rule.is_flag and not rule.words])
def test_the_bounds_of_a_rule_are_those_of_its_variable(match, name):
    lowest, highest = DECLARED[name].lowest, DECLARED[name].highest
    assert lowest is not None
    assert highest is not None
    for value in (lowest, highest):
        operate(match, desk.change_rules, changes={name: value})
    for value in (lowest - 0.1, highest + 1):
        with pytest.raises(ValueError, match="must be"):
            operate(match, desk.change_rules, changes={name: value})


def test_only_so_many_seats_are_given(match):
    operate(match, desk.change_rules, changes={"seats": 2})
    join(match, "ada", "bob", "cy")
    assert match.names == ["ada", "bob"]
    assert queue(match) == [("cy", None)]
    assert match.state.free_robots == ()
    assert match.referee.sign_up("dee", "d", 0, match.now, wanted=3)[0] is Verdict.ROBOT_UNAVAILABLE
    match.sign_out("ada")
    assert queue(match) == [("cy", 0)]
    join(match, "dee")
    assert queue(match) == [("cy", 0), ("dee", None)], "an offer is a seat, too"
    operate(match, desk.change_rules, changes={"seats": 3})
    assert queue(match) == [("cy", 0), ("dee", 2)]
    operate(match, desk.change_rules, changes={"seats": 1})
    assert match.names == ["bob"], "nobody is sent away"
    operate(match, desk.change_rules, changes={"seats": None})
    assert match.state.available_robots == 1


# robots out of service


def test_the_player_of_a_robot_that_goes_out_of_service_is_the_next_to_get_one(new_match):
    match = new_match(robots=2)
    join(match, "ada", "bob", "cy", "dee")
    operate(match, desk.set_service, robot_id=0, in_service=False)
    assert match.names == ["bob"]
    assert queue(match) == [("ada", None), ("cy", None), ("dee", None)]
    operate(match, desk.set_service, robot_id=1, in_service=False)
    assert queue(match) == [("ada", None), ("bob", None), ("cy", None), ("dee", None)]
    operate(match, desk.set_service, robot_id=1, in_service=True)
    assert queue(match)[0] == ("ada", 1)
    assert take(match, "ada") is Verdict.OK


def test_with_a_free_robot_it_is_offered_at_once(match):
    join(match, "ada")
    operate(match, desk.set_service, robot_id=0, in_service=False)
    assert queue(match) == [("ada", 1)]


def test_a_robot_out_of_service_is_neither_offered_nor_claimed(match):
    operate(match, desk.set_service, robot_id=0, in_service=False)
    assert match.state.available_robots == 3
    assert match.referee.sign_up("ada", "a", 0, match.now, wanted=0)[0] is Verdict.ROBOT_UNAVAILABLE
    match.sign_up("ada")
    assert match.player("ada").robot == 1


def test_an_offer_of_it_ends_and_the_place_in_the_queue_stays(new_match):
    match = new_match(robots=1)
    join(match, "ada", "bob", "cy")
    match.sign_out("ada")
    assert queue(match) == [("bob", 0), ("cy", None)]
    operate(match, desk.set_service, robot_id=0, in_service=False)
    assert queue(match) == [("bob", None), ("cy", None)]
    assert take(match, "bob") is Verdict.NO_OFFER
    operate(match, desk.set_service, robot_id=0, in_service=True)
    assert queue(match) == [("bob", 0), ("cy", None)]


def test_it_stays_out_of_service_when_it_comes_back(match):
    operate(match, desk.set_service, robot_id=2, in_service=False)
    match.wait(4, dead_robots=(2,))
    assert match.state.robots == (0, 1, 3)
    assert match.referee.overview(match.now)["robots"][2]["in_service"] is False
    assert match.referee.add_robot("/id_service_client_2", match.now) == 2
    assert match.state.available_robots == 3


def test_in_a_battle_its_player_has_left_it(match):
    match.start("ada", "bob", "cy")
    operate(match, desk.set_service, robot_id=0, in_service=False)
    match.hit("bob", 10)
    assert match.ranking == [(1, "cy"), (2, "bob"), (3, "ada")]
    journal = match.referee.take_journal()
    assert replay(journal) == match.state.result
    kept = [(one.at, kind_of(one.event), to_json(one.event)) for one in journal]
    assert [(course.name, course.left) for course in courses(kept)] == [("ada", 0.0), ("bob", None), ("cy", None)]


# names


def test_who_is_banned_goes_also_from_the_queue(new_match):
    match = new_match(robots=1)
    join(match, "ada", "bob")
    for name in ("Bob", "ada"):
        operate(match, desk.ban, name=name)
    assert (match.names, queue(match)) == ([], [])
    assert match.referee.sign_up("BOB", "b", 0, match.now)[0] is Verdict.NAME_BANNED
    operate(match, desk.unban, name="bob")
    assert match.referee.sign_up("BOB", "b", 0, match.now)[0] is Verdict.OK


def test_words_are_found_in_any_case_and_form_and_present_players_stay(match):
    match.sign_up("Grindamnit")
    operate(match, desk.set_words, words=["Damn", "straße"])
    for name in ("GODDAMN", "damn", "STRASSE1", "ｄａｍｎ"):
        assert match.referee.sign_up(name, "s", 0, match.now)[0] is Verdict.NAME_UNWANTED
    session = match.session("Grindamnit")
    assert match.referee.sign_up("Grindamnit", "s", 0, match.now, old_session=session)[0] is Verdict.OK


def test_who_is_signed_out_in_a_battle_has_left_it(match):
    match.start("ada", "bob")
    operate(match, desk.sign_out, name="ADA")
    assert match.ranking == [(1, "bob"), (2, "ada")]
    assert match.state.notice == "Battle over: ada was signed out by the operator."


# what is kept


def decided_all(match) -> None:
    """Robots 0 to 3; ada and bob fight in a pause."""
    match.start("ada", "bob")
    match.hit("bob", 2)
    operate(match, desk.pause)
    operate(match, desk.add_time, seconds=30)
    operate(match, desk.change_rules, changes={"hit_damage": 30, "seats": 3})
    operate(match, desk.set_service, robot_id=3, in_service=False)
    operate(match, desk.ban, name="cy")
    operate(match, desk.set_words, words=["damn"])
    operate(match, desk.save_preset, name="ours")
    operate(match, desk.show, text="Hello")


def test_what_operators_have_decided_outlives_the_program(match):
    decided_all(match)
    before, overview = match.state, match.referee.overview(match.now)
    match.restart(pause=500.0)
    after = match.referee.overview(match.now)
    assert match.state == before
    assert after["game"] == overview["game"], "the clock stands while the program is away, too"
    for part in ("rules", "presets", "names"):
        assert after[part] == overview[part]
    assert [robot["in_service"] for robot in after["robots"]] == [True, True, True, False]
    operate(match, desk.resume)
    match.hit("bob")
    assert match.player("bob").life == 50


def test_a_place_at_the_head_of_the_queue_outlives_the_program(new_match):
    match = new_match(robots=2)
    join(match, "ada", "bob", "cy")
    operate(match, desk.set_service, robot_id=0, in_service=False)
    match.restart()
    operate(match, desk.set_service, robot_id=1, in_service=False)
    assert queue(match) == [("ada", None), ("bob", None), ("cy", None)]


def test_the_state_of_an_older_program_is_understood(match):
    match.start("ada", "bob")
    saved = match.referee.saved(match.now)
    for news in ("paused", "out_of_service", "rules", "presets", "banned", "words", "message", "bots"):
        del saved[news]
    before = match.state
    match.referee.saved = lambda now: saved
    match.restart()
    assert match.state == before


def test_a_battle_with_pauses_played_again_from_its_events_has_the_same_result(match):
    decided_all(match)
    match.hit("ada", 5)
    match.wait(60)
    operate(match, desk.resume)
    match.hit("ada", 4)
    assert match.ranking == [(1, "bob"), (2, "ada")]
    journal: list[Recorded] = match.referee.take_journal()
    assert replay(journal) == match.state.result


def test_what_an_earlier_program_knew_comes_to_light_late(match):
    match.sign_up("ada")
    for wish in (
        partial(desk.ban, by="Ann", name="eve"),
        partial(desk.set_words, by="Ann", words=["bad"]),
        partial(desk.set_service, by="Ann", robot_id=3, in_service=False),
        partial(desk.change_rules, by="Ann", changes={"hit_damage": 25}),
        partial(desk.give_to_bot, by="Ann", robot_id=2, level="hard"),
    ):
        match.referee.operate(wish, match.now)
    saved = json.loads(json.dumps(match.referee.saved(match.now)))
    late = Referee(Rules())
    late.operate(partial(desk.ban, by="Bob", name="mallory"), 50.0)
    late.take_over(saved, {"/away": 9}, 50.0)
    after = late.saved(50.0)
    assert after["banned"] == ["mallory", "eve"]
    assert (after["words"], after["out_of_service"], after["rules"]) == (["bad"], [3], {"hit_damage": 25})
    assert after["bots"] == {"2": "hard"}
    assert late.add_robot("/away", 51.0) == 9
    late.take_over(saved, {}, 52.0)
    assert late.saved(52.0)["banned"] == ["mallory", "eve"], "once"
