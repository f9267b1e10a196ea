"""Which light counts as a hit, whose it is, and what players have to show for it."""

import json

import pytest

from laser_bot_battle.light_protocol import COOLDOWN, DAMAGES
from server.game import events
from server.game.emitter import DELAY, PULSE, damage_code
from server.game.events import from_json, kind_of, to_json
from server.game.replay import replay
from server.game.rules import Rules
from tests.unit.server.conftest import Match

CODED = Rules(light="coded")


def robot(match: Match, name: str) -> int:
    return match.player(name).robot


def fire(match: Match, name: str) -> bool:
    return match.referee.shot(robot(match, name), match.now)


def lit(match: Match, name: str) -> bool:
    """Plain light on the robot of `name`."""
    return match.referee.hit(robot(match, name), match.now, shots_told=True)


def met(match: Match, name: str, by: str | int, code: int = 0) -> bool:
    """A packet on the robot of `name`."""
    shooter = robot(match, by) if isinstance(by, str) else by
    return match.referee.shot_hit(robot(match, name), shooter, code, match.now, shots_told=True)


def score(match: Match, name: str) -> tuple[int, int, int]:
    """Shots, hits and kills."""
    match.now += 0.1
    player = match.player(name)
    return player.shots, player.hits, player.kills


def happened(match: Match) -> list[tuple[str, str, int]]:
    return [(one.name, one.by, one.life) for one in match.state.happened]


@pytest.fixture
def coded(new_match) -> Match:
    match = new_match(rules=CODED)
    match.start("ada", "bob", "cy")
    return match


def test_plain_light_without_a_shot_is_a_lamp(match):
    match.start("ada", "bob")
    assert not lit(match, "ada")
    assert fire(match, "bob")
    assert lit(match, "ada")
    assert match.player("ada").life == 90


def test_ten_hits_at_once_are_one_and_each_shot_counts_once_for_each_robot(match):
    match.start("ada", "bob", "cy")
    fire(match, "bob")
    assert [lit(match, "ada") for _ in range(10)] == [True] + [False] * 9
    match.now += 0.2
    assert not lit(match, "ada"), "the same pulse of light"
    assert lit(match, "cy"), "the beam has moved on"


def test_the_light_of_a_shot_is_over_after_its_pulse_and_the_way_of_the_news(match):
    match.start("ada", "bob")
    fire(match, "bob")
    match.now += PULSE + DELAY + 0.01
    assert not lit(match, "ada")


def test_nobody_is_hit_by_the_own_light(match):
    match.start("ada", "bob")
    fire(match, "ada")
    assert not lit(match, "ada")


def test_plain_light_tells_the_shooter_only_if_it_can_be_nobody_elses(match):
    match.start("ada", "bob", "cy")
    fire(match, "bob")
    lit(match, "ada")
    match.now += 1
    fire(match, "bob")
    fire(match, "cy")
    lit(match, "ada")
    assert happened(match) == [("ada", "bob", 90), ("ada", "", 80)]
    assert score(match, "bob") == (2, 1, 0)


def test_where_nobody_tells_of_shots_any_light_counts_as_ever(match):
    match.start("ada", "bob")
    assert match.hit("ada") == [True]
    assert happened(match) == [("ada", "", 90)]


def test_a_robot_shoots_once_a_cooldown_whatever_it_is_told(match):
    match.start("ada", "bob")
    begun = match.now
    while match.now < begun + 10:
        fire(match, "bob")
        match.wait(0.025)
    assert score(match, "bob")[0] in range(20, 23)


def test_only_living_fighters_of_a_running_battle_shoot(match):
    match.sign_up("ada", "bob", "cy")
    assert not fire(match, "bob")
    match.ready("ada", "bob", "cy")
    match.wait(15)
    match.sign_up("dee")
    assert not fire(match, "dee")
    match.hit("cy", 10)
    assert not fire(match, "cy")
    assert not match.referee.shot(77, match.now)
    assert fire(match, "bob")


def test_a_packet_counts_if_its_robot_has_just_fired_it(coded):
    assert not met(coded, "ada", by="bob")
    fire(coded, "bob")
    coded.now += 0.04
    assert not met(coded, "ada", by="cy"), "who has not fired"
    assert met(coded, "ada", by="bob")
    assert not met(coded, "ada", by="bob"), "the same packet"
    assert met(coded, "cy", by="bob"), "which another robot sees, too"
    assert happened(coded) == [("ada", "bob", 90), ("cy", "bob", 90)]
    assert score(coded, "bob") == (1, 2, 0)


def test_a_packet_may_be_fired_a_cooldown_after_its_news_and_no_later(coded):
    """By a robot that still cooled down."""
    fire(coded, "bob")
    coded.now += COOLDOWN + DELAY - 0.01
    assert met(coded, "ada", by="bob")
    coded.now += 0.02
    assert not met(coded, "cy", by="bob")


def test_a_shot_whose_news_was_late_costs_the_next_one_nothing(coded):
    coded.now += 0.29  # this program stood still
    assert fire(coded, "bob")
    coded.now += COOLDOWN - 0.29
    assert fire(coded, "bob")


def test_two_shooters_at_once_both_hit(coded):
    fire(coded, "bob")
    fire(coded, "cy")
    assert met(coded, "ada", by="bob")
    assert met(coded, "ada", by="cy")
    assert coded.player("ada").life == 80


def test_packets_of_oneself_of_strangers_and_of_spectators_do_not_count(coded):
    coded.sign_up("dee")
    for name in ("ada", "bob", "dee"):
        fire(coded, name)
    assert not met(coded, "ada", by="ada")
    assert not met(coded, "ada", by="dee")
    assert not met(coded, "ada", by=99)
    assert not met(coded, "dee", by="bob")


def test_each_mode_hears_its_own_kind_of_hit_only(match, coded):
    fire(coded, "bob")
    assert not lit(coded, "ada")
    match.start("ada", "bob")
    fire(match, "bob")
    assert not met(match, "ada", by="bob")


def test_a_shot_of_who_has_died_meanwhile_still_counts(coded):
    for _ in range(10):
        coded.wait(COOLDOWN)
        fire(coded, "cy")
        fire(coded, "bob")
        met(coded, "bob", by="cy")
    assert coded.player("bob").life == 0
    assert met(coded, "ada", by="bob")
    assert score(coded, "bob") == (10, 1, 0)
    assert score(coded, "cy") == (10, 10, 1)
    coded.wait(COOLDOWN)
    assert not fire(coded, "bob")


def test_packets_count_without_news_of_shots_once_a_cooldown(coded):
    """Where somebody else's rosbridge lets people drive."""
    ada, bob = robot(coded, "ada"), robot(coded, "bob")
    hits = [coded.referee.shot_hit(ada, bob, 0, coded.now) for _ in range(10)]
    assert hits == [True] + [False] * 9
    coded.wait(COOLDOWN)
    assert coded.referee.shot_hit(ada, bob, 0, coded.now)
    assert not coded.referee.shot_hit(ada, 99, 0, coded.now)


def test_damage_is_the_rules_unless_the_light_is_to_say_it(new_match):
    for rules, life in ((CODED, 90), (Rules(light="coded", light_damage=True), 65)):
        match = new_match(rules=rules)
        match.start("ada", "bob")
        fire(match, "bob")
        met(match, "ada", by="bob", code=11)
        assert match.player("ada").life == life


def test_the_nearest_code_stands_for_a_damage():
    assert [DAMAGES[damage_code(damage)] for damage in (1, 3, 10, 12, 45, 60, 100)] == [1, 2, 10, 10, 40, 50, 100]


def test_the_result_has_shots_hits_and_kills_and_so_has_the_battle_played_again(coded):
    fire(coded, "ada")
    for _ in range(10):
        coded.wait(COOLDOWN)
        fire(coded, "bob")
        met(coded, "cy", by="bob")
    for _ in range(10):
        coded.wait(COOLDOWN)
        fire(coded, "bob")
        met(coded, "ada", by="bob")
    assert [(one.name, one.shots, one.hits, one.kills) for one in coded.state.result] == [
        ("bob", 20, 20, 2),
        ("ada", 1, 0, 0),
        ("cy", 0, 0, 0),
    ]
    journal = coded.referee.take_journal()
    assert replay(journal) == coded.state.result
    kept = [from_json(kind_of(one.event), json.loads(json.dumps(to_json(one.event)))) for one in journal]
    assert kept == [one.event for one in journal]
    assert not [one for one in kept if type(one).__name__ == "Shot"], "shots are counted, not written down"


def test_who_has_left_is_still_named_and_counted(coded):
    fire(coded, "bob")
    coded.sign_out("bob")
    assert met(coded, "ada", by=1)
    for _ in range(10):
        coded.wait(COOLDOWN)
        fire(coded, "cy")
        met(coded, "ada", by="cy")
    assert [(one.name, one.shots, one.hits, one.kills) for one in coded.state.result] == [
        ("cy", 9, 9, 1),
        ("ada", 0, 0, 0),
        ("bob", 1, 1, 0),
    ]


def test_the_last_eight_happenings_are_told_and_numbered_through_all_battles(match):
    match.start("ada", "bob")
    match.hit("ada", 10)
    assert [one.number for one in match.state.happened] == list(range(3, 11))
    match.ready("ada", "bob")
    assert match.state.happened, "those of the last battle"
    match.wait(15)
    assert match.state.happened == ()
    match.hit("bob")
    assert [one.number for one in match.state.happened] == [11]


def test_counts_and_happenings_outlive_the_program(coded):
    fire(coded, "bob")
    met(coded, "ada", by="bob")
    before = score(coded, "bob"), coded.state.happened
    coded.restart()
    assert (score(coded, "bob"), coded.state.happened) == before


def test_what_only_a_newer_program_saves_is_left_out(match):
    match.start("ada", "bob")
    match.hit("bob", 10)
    saved = match.referee.saved(match.now)
    before = match.state.result, match.state.happened
    for one in (saved, *saved["users"], *saved["result"], *saved["happened"]):
        one["of_tomorrow"] = 1
    match.restart(saved=saved)
    assert (match.state.result, match.state.happened) == before
    assert len(before[0]) == 2


def test_what_an_older_program_has_saved_and_recorded_is_read(match):
    match.start("ada", "bob")
    match.hit("bob")
    saved = match.referee.saved(match.now)
    for name in ("teams", "happened", "happenings"):
        del saved[name]
    for user in saved["users"]:
        for name in ("wish", "team", "shots", "hits", "kills"):
            del user[name]
    match.restart(saved=saved)
    assert match.player("bob").life == 90
    assert from_json("Hit", {"name": "bob", "robot": 1, "life": 90}) == events.Hit("bob", 1, 90)
    fighter = {"name": "bob", "robot": 1, "avatar": 0}
    began = from_json("BattleStarted", {"battle": 1, "seconds": 300, "fighters": [fighter], "by": ""})
    assert began == events.BattleStarted(1, 300, (events.Fighter("bob", 1, 0),))
    placing = {"name": "bob", "robot": 1, "life": 0, "avatar": 0, "place": 1, "left": False}
    assert from_json("BattleEnded", {"battle": 1, "cause": "", "result": [placing]})
