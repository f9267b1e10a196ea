"""The state of the game as JSON, and back in another program."""

import json
from functools import partial

import pytest

from server.game import desk, events
from server.game.events import Event, Recorded, from_json, kind_of, to_json
from server.game.persistence import restore
from server.game.referee import Referee
from server.game.replay import replay
from server.game.rules import Rules


def test_the_game_goes_on_as_it_was(match):
    match.start("ada", "bob", "cyd")
    match.hit("bob", 3)
    match.sign_out("cyd")
    before = match.state
    match.restart()
    assert match.state == before


def test_clock_and_limit_have_gone_on_meanwhile(match):
    match.start("ada", "bob")
    left = match.state.time_left
    match.restart(pause=7.0)
    assert match.state.time_left == pytest.approx(left - 7)


def test_a_battle_whose_limit_has_passed_meanwhile_is_over(match):
    match.start("ada", "bob")
    match.hit("bob")
    match.restart(pause=400.0)
    assert match.ranking == [(1, "ada"), (2, "bob")]


def test_pages_have_their_whole_time_to_be_heard_again(match):
    match.start("ada", "bob")
    match.restart(pause=100.0)
    match.wait(14.9, gone_pages=("ada", "bob"))
    assert match.names == ["ada", "bob"]
    match.wait(0.2, gone_pages=("ada", "bob"))
    assert match.names == ["bob"], "who is in no battle any more has more time"


def test_robots_have_the_time_that_their_programs_need_to_start(match):
    match.start("ada", "bob")
    match.restart(pause=100.0)
    match.now += 14.9
    assert match.state.robots == (0, 1, 2, 3)
    assert match.state.game == 2
    match.now += 5.2
    assert match.state.robots == ()


def test_robots_may_ping_once_more_before_their_programs_start_again(match):
    match.start("ada", "bob")
    match.restart()
    match.wait(1.0)
    match.wait(18.9, dead_robots=(0,))
    assert match.state.robots == (0, 1, 2, 3)
    assert match.state.game == 2
    match.wait(0.2, dead_robots=(0,))
    assert match.state.robots == (1, 2, 3)


def test_who_died_first_is_still_last(match):
    match.start("ada", "bob", "cyd")
    match.hit("cyd", 10)
    match.wait(1)
    match.restart()
    match.hit("bob", 10)
    assert match.ranking == [(1, "ada"), (2, "bob"), (3, "cyd")]


def test_the_result_tells_hits_and_time_of_the_whole_battle(match):
    match.start("ada", "bob", "cyd")
    match.hit("bob", 3)
    match.wait(2)
    match.restart(pause=5.0)
    match.hit("bob", 7)
    match.wait(4)
    match.hit("cyd", 10)
    placings = [match.placing(name) for name in ("ada", "bob", "cyd")]
    assert [placing.taken for placing in placings] == [0, 10, 10]
    lasted, bob, cyd = (placing.seconds for placing in placings)
    assert bob + 4 < lasted == cyd
    assert bob > 7


def test_sessions_are_kept(match):
    match.sign_up("ada")
    match.restart()
    assert match.referee.seen(match.session("ada"), match.now).name == "ada"
    match.sign_out("ada")
    assert match.state.available_robots == 4


@pytest.mark.parametrize("change", [{"users": 3}, {"game": 9}, {"left": "soon"}, {"robots": [[1]]}, {"result": [{}]}])
def test_what_is_no_state_is_refused(match, change):
    with pytest.raises(ValueError, match=r"state|Game|convert|unpack"):
        restore(match.referee.saved(match.now) | change, {}, 50.0, 0.0)


def kept(match) -> list[Recorded]:
    """The journal, through JSON."""

    def through_json(event: Event) -> Event:
        return from_json(kind_of(event), json.loads(json.dumps(to_json(event))))

    return [Recorded(one.at, through_json(one.event)) for one in match.referee.take_journal()]


def test_every_event_survives_json(match):
    match.start("ada", "bob")
    match.hit("bob", 10)
    match.wait(5, dead_robots=(0,))
    match.referee.extend_deadlines(2.0, match.now)
    match.sign_up("cyd", "dan")
    match.ready("cyd", "dan")
    for wish in (desk.pause, desk.resume, desk.start, desk.abort):
        match.referee.operate(partial(wish, by="Ann"), match.now)
    for event in (
        events.TimeAdded(5.0, "Ann"),
        events.RulesChanged({"hit_damage": 5, "practice": True, "idle": None}, "Ann"),
        events.PresetSaved("ours", {"hit_damage": 5, "idle": None}, "Ann"),
        events.PresetRemoved("ours", "Ann"),
        events.ServiceChanged(2, False, "Ann"),
        events.BotChosen(2, "easy", "Ann"),
        events.BotChosen(2, "", "Ann"),
        events.NameBanned("eve", "Ann"),
        events.NameUnbanned("eve", "Ann"),
        events.WordsChanged(("damn",), "Ann"),
        events.MessageShown("hello", "Ann"),
    ):
        match.referee.operate(lambda *_, event=event: [event], match.now)
    journal = list(match.referee._journal)
    assert kept(match) == journal


def test_a_battle_played_again_from_its_events_has_the_same_result(match):
    match.start("ada", "bob", "cyd", "dan")
    match.hit("bob", 10)
    match.wait(1)
    match.wait(4, dead_robots=(0,))
    match.hit("cyd", 4)
    match.sign_out("dan")
    assert match.ranking == [(1, "cyd"), (2, "bob"), (3, "dan"), (4, "ada")]
    assert replay(kept(match)) == match.state.result


@pytest.mark.parametrize(
    "kind, fields", [("Hit", {}), ("Hut", {}), ("BattleEnded", {"result": [1]}), ("Hit", {"x": 1})]
)
def test_what_is_no_event_is_refused(kind, fields):
    with pytest.raises(ValueError, match="no event"):
        from_json(kind, fields)


def test_a_robot_whose_id_the_operator_has_changed_meanwhile_registers_anew(match):
    match.sign_up("ada")
    saved = match.referee.saved(match.now)
    referee = Referee(Rules(), restore(saved, {"/id_service_client_0": 7}, 50.0, 0.0))
    assert 0 not in referee.snapshot(50.0).robots
    assert referee.add_robot("/id_service_client_0", 51.0) == 7
    referee.tick(50.0 + 11)
    assert referee.snapshot(61.0).players == (), "the player's robot is another one now"
