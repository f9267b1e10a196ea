"""Hits, the end of a battle and its result."""

import re

import pytest

from server.game.robot import HIT_INTERVAL
from server.game.rules import Rules
from tests.support.programs import ROOT


def test_a_hit_costs_ten_of_hundred_and_never_goes_below_zero(new_match):
    match = new_match(rules=Rules(hit_damage=30))
    match.start("ada", "bob", "cy")
    lives = []
    for _ in range(5):
        match.hit("ada")
        lives.append(match.player("ada").life)
    assert lives == [70, 40, 10, 0, 0]


def test_default_damage_is_ten(match):
    match.start("ada", "bob")
    match.hit("ada")
    assert match.player("ada").life == 90


def test_hits_count_only_in_a_battle(match):
    match.sign_up("ada", "bob")
    assert match.hit("ada") == [False]
    match.ready("ada", "bob")
    assert match.hit("ada") == [False]
    assert match.player("ada").life == 100


def test_hits_on_spectators_free_robots_and_unknown_robots_do_not_count(match):
    match.start("ada", "bob")
    match.sign_up("cy")
    before = match.state
    assert match.hit("cy") == [False]
    assert [match.referee.hit(robot, match.now) for robot in (3, 99, -1)] == [False, False, False]
    assert match.state == before


def test_a_robot_is_hit_as_fast_as_its_firmware_reports_hits_and_not_faster(match):
    match.start("ada", "bob")
    assert [match.referee.hit(0, match.now) for _ in range(10)] == [True] + [False] * 9
    assert match.referee.hit(1, match.now), "another robot"
    match.now += 0.04
    assert not match.referee.hit(0, match.now)
    match.now += 0.02
    assert match.referee.hit(0, match.now), "the network has held up the first"
    match.now += 0.08
    assert not match.referee.hit(0, match.now), "two in 140 ms, and no third"
    assert match.player("ada").life == 80


def test_in_the_long_run_a_flood_of_hits_counts_ten_a_second(new_match):
    match = new_match(rules=Rules(hit_damage=1))
    match.start("ada", "bob")
    begun = match.now
    while match.now < begun + 2.0:
        match.now += 0.01
        match.referee.hit(0, match.now)
    assert 100 - match.player("ada").life in (20, 21)


def test_the_least_interval_of_hits_is_the_firmwares():
    source = (ROOT / "firmware/laserbot/src/ir/hit_detector.h").read_text()
    interval = re.search(r"MIN_HIT_INTERVAL_MS = (\d+);", source)
    assert interval
    assert int(interval[1]) / 1000 == HIT_INTERVAL


def test_a_dead_player_is_not_hit_again(match):
    match.start("ada", "bob", "cy")
    match.hit("ada", times=10)
    assert match.hit("ada") == [False]


def test_battle_ends_when_one_is_left_and_the_server_names_the_winner(match):
    match.start("ada", "bob")
    match.hit("ada", times=9)
    match.hit("bob", times=10)
    assert match.state.game == 0
    assert match.ranking == [(1, "ada"), (2, "bob")]
    assert (match.placing("ada").life, match.placing("bob").life) == (10, 0)
    assert "bob was shot down" in match.state.notice


def test_the_user_list_is_in_ranking_order_at_the_moment_of_the_end(match):
    match.start("ada", "bob")
    match.hit("ada", times=9)
    assert match.names == ["bob", "ada"]
    match.hit("bob", times=10)
    assert match.names == ["ada", "bob"]
    assert match.player("ada").life > 0


def test_the_dead_are_ranked_by_time_of_death_latest_first(match):
    match.start("ada", "bob", "cy", "dee")
    for name in ("cy", "ada", "dee"):
        match.wait(1)
        match.hit(name, times=10)
    assert match.ranking == [(1, "bob"), (2, "dee"), (3, "ada"), (4, "cy")]


def test_survivors_at_the_time_limit_are_ranked_by_life_and_ties_share_a_place(match):
    match.start("ada", "bob", "cy", "dee")
    match.hit("ada", times=2)
    match.hit("cy", times=2)
    match.hit("dee", times=10)
    match.wait(match.state.time_left - 0.1)
    assert match.state.game == 2
    match.wait(0.1)
    assert match.state.game == 0
    assert sorted(match.ranking) == [(1, "bob"), (2, "ada"), (2, "cy"), (4, "dee")]
    assert "time limit" in match.state.notice


def test_who_dies_in_the_same_instant_shares_a_place(match):
    match.start("ada", "bob", "cy", "dee")
    for _ in range(10):
        match.hit("bob")
        match.referee.hit(match.player("cy").robot, match.now)
    match.wait(1)
    match.hit("dee", times=10)
    assert sorted(match.ranking) == [(1, "ada"), (2, "dee"), (3, "bob"), (3, "cy")]


def test_quitters_come_after_the_dead_latest_first(match):
    match.start("ada", "bob", "cy", "dee")
    match.sign_out("ada")
    match.wait(1)
    match.sign_out("cy")
    match.wait(1)
    match.hit("dee", times=10)
    assert match.ranking == [(1, "bob"), (2, "dee"), (3, "cy"), (4, "ada")]
    assert {placing.name: placing.left for placing in match.state.result} == {
        "bob": False,
        "dee": False,
        "cy": True,
        "ada": True,
    }


def test_who_leaves_after_death_stays_among_the_dead(match):
    match.start("ada", "bob", "cy", "dee")
    match.hit("bob", times=10)
    match.wait(1)
    match.sign_out("bob")
    match.sign_out("cy")
    match.hit("dee", times=10)
    assert match.ranking == [(1, "ada"), (2, "dee"), (3, "bob"), (4, "cy")]
    assert match.placing("bob").left


def test_the_last_opponent_leaving_ends_the_battle(match):
    match.start("ada", "bob")
    match.sign_out("bob")
    assert match.state.game == 0
    assert match.ranking == [(1, "ada"), (2, "bob")]
    assert "bob signed out" in match.state.notice


def test_spectators_are_in_no_result(match):
    match.start("ada", "bob")
    match.sign_up("cy")
    match.sign_out("cy")
    match.sign_up("dee")
    match.hit("ada", times=10)
    assert match.ranking == [(1, "bob"), (2, "ada")]


def test_a_name_reused_after_quitting_is_another_player(match):
    match.start("ada", "bob", "cy")
    match.sign_out("bob")
    match.sign_up("bob")
    assert not match.player("bob").ready
    match.hit("ada", times=10)
    assert match.ranking == [(1, "cy"), (2, "ada"), (3, "bob")]
    assert match.names == ["cy", "ada", "bob"]


def test_after_the_end_nobody_is_ready_and_the_result_stays_until_the_next_countdown(match):
    match.start("ada", "bob")
    match.hit("bob", times=10)
    assert not any(player.ready for player in match.state.players)
    match.wait(60)
    match.ready("ada")
    assert match.ranking == [(1, "ada"), (2, "bob")]
    match.ready("bob")
    assert match.state.result == ()
    assert match.state.notice == ""


def test_a_second_battle_starts_from_scratch(match):
    match.start("ada", "bob", "cy")
    match.sign_out("cy")
    match.hit("bob", times=10)
    match.ready("ada", "bob")
    match.wait(15)
    assert match.state.battle == 2
    assert [player.life for player in match.state.players] == [100, 100]
    match.hit("ada", times=10)
    assert match.ranking == [(1, "bob"), (2, "ada")]


def test_playing_users_come_first_by_life_and_equals_keep_their_order(match):
    match.sign_up("zoe")
    match.start("ada", "bob", "cy")
    assert match.names == ["ada", "bob", "cy", "zoe"]
    match.hit("ada")
    assert match.names == ["bob", "cy", "ada", "zoe"]


def test_time_left_in_a_battle_is_that_to_its_limit(match):
    match.start("ada", "bob")
    match.wait(10)
    assert match.state.time_left == pytest.approx(290)


def test_deadlines_are_applied_in_order_even_when_nobody_ticked_for_long(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.now += 100  # robots silent after 3 s: the countdown stopped before any battle
    assert match.state.game == 0
    assert match.state.battle == 0
    assert match.state.robots == ()
    assert match.state.players == ()


def test_a_hit_after_the_countdown_counts_though_no_tick_came_between(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.wait(14.9)
    match.now += 0.2
    assert match.hit("ada") == [True]


def test_everything_that_happens_is_in_the_journal(match):
    match.start("ada", "bob")
    match.hit("bob", times=10)
    journal = [str(recorded.event) for recorded in match.referee.take_journal()]
    assert "robot 0 registered by /id_service_client_0" in journal
    assert "ada signed up and drives robot 0" in journal
    assert "bob (robot 1) has been hit, life 90" in journal
    assert journal[-1] == "battle 1 over: bob was shot down; ranking: 1 ada, 2 bob"
    assert match.referee.take_journal() == []
