"""From stopped to playing: who is ready, and how long it takes."""

import pytest

from server.game.referee import Verdict


def test_two_ready_players_start_a_countdown_of_15_seconds(match):
    match.sign_up("ada", "bob")
    match.ready("ada")
    assert match.state.game == 0
    match.ready("bob")
    assert match.state.game == 1
    assert match.state.time_left == pytest.approx(15)
    assert match.state.notice == ""


def test_the_countdown_takes_15_seconds_for_four_players_who_ready_in_turn(match):
    names = ("ada", "bob", "cy", "dee")
    match.sign_up(*names)
    seen = []
    for name in names:
        match.ready(name)
        match.wait(2)
        seen.append((match.state.game, match.state.time_left))
    assert seen == [(0, 0), (1, pytest.approx(13)), (1, pytest.approx(11)), (1, pytest.approx(9))]
    match.wait(8.9)
    assert match.state.game == 1
    match.wait(0.1)
    assert match.state.game == 2
    assert match.state.battle == 1


def test_the_time_left_is_never_below_zero(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    times = []
    for _ in range(400):
        match.wait(0.04)
        times.append(match.state.time_left)
    assert min(times) >= 0


def test_repeating_ready_changes_nothing(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.wait(5)
    before = match.state
    match.referee.take_journal()
    match.ready("ada", "bob")
    assert match.state == before
    assert match.referee.take_journal() == []
    assert match.state.time_left == pytest.approx(10)


def test_toggling_ready_does_not_restart_the_countdown_while_two_others_are_ready(match):
    match.sign_up("ada", "bob", "cy")
    match.ready("ada", "bob", "cy")
    match.wait(12)
    match.ready("cy", ready=False)
    match.ready("cy")
    assert match.state.time_left == pytest.approx(3)


def test_ready_players_get_full_life_and_others_keep_theirs(match):
    match.start("ada", "bob")
    match.sign_up("cy")
    match.hit("ada", times=3)
    match.hit("bob", times=10)
    assert match.state.game == 0
    match.ready("bob", "cy")
    assert {player.name: player.life for player in match.state.players} == {"ada": 70, "bob": 100, "cy": 100}


def test_a_late_joiner_gets_full_life_too(match):
    match.start("ada", "bob", "cy")
    match.hit("ada", times=10)
    match.hit("bob", times=10)
    match.ready("bob", "cy")
    match.wait(5)
    match.ready("ada")
    assert match.player("ada").life == 100
    assert match.state.time_left == pytest.approx(10)


def test_countdown_stops_at_once_when_fewer_than_two_are_ready(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.wait(3)
    match.ready("bob", ready=False)
    assert match.state.game == 0
    assert match.state.time_left == 0
    assert "bob is no longer ready" in match.state.notice
    assert match.player("ada").ready
    match.wait(20)
    assert match.state.game == 0
    assert match.state.battle == 0


def test_countdown_stops_when_a_player_signs_out(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.sign_out("ada")
    assert match.state.game == 0
    assert "ada signed out" in match.state.notice
    assert match.state.result == ()


def test_a_new_countdown_after_a_stopped_one_lasts_15_seconds_again(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.wait(14)
    match.ready("bob", ready=False)
    match.ready("bob")
    assert match.state.notice == ""
    assert match.state.time_left == pytest.approx(15)


def test_ready_right_after_a_battle_stays(match):
    match.start("ada", "bob")
    match.hit("bob", times=10)
    match.ready("ada")
    match.wait(5)
    assert match.player("ada").ready
    assert match.state.game == 0


@pytest.mark.parametrize("ready", [True, False])
@pytest.mark.parametrize("name", ["ada", "nobody"])
def test_ready_in_a_battle_is_answered_with_started(match, name, ready):
    match.start("ada", "bob")
    before = match.state
    assert match.referee.set_ready(name, ready, match.session(name), match.now) is Verdict.STARTED
    assert match.state == before


def test_nobody_gets_another_player_ready(match):
    match.sign_up("ada", "bob")
    assert match.referee.set_ready("ada", True, match.session("bob"), match.now) is Verdict.NOT_YOURS
    assert match.referee.set_ready("cy", True, match.session("cy"), match.now) is Verdict.UNKNOWN_USER
    assert not match.player("ada").ready
