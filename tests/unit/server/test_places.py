"""The rules of place: what the referee decides by where the robots are."""

import math
from functools import partial
from typing import Any

import pytest

from laser_bot_battle.floor import Zone
from laser_bot_battle.msg import GameEvent
from server.game import changes, desk, events, place_events
from server.game.events import kind_of, to_json
from server.game.places import SEEN
from server.game.replay import replay
from server.game.rules import Rules
from server.game.sight import REMEMBERED, Moment, Sides, beyond, could_meet
from server.game.state import TOLD, State
from server.game.users import User
from server.ros.status import to_message
from server.store.course import courses
from server.store.marks import effects, marks
from server.store.marks import points as points_of_hills
from server.web.watch import public_status
from tests.unit.server.conftest import Match

EAST, NORTH, WEST = 0.0, math.pi / 2, math.pi
WIDTH, HEIGHT = 4.0, 2.0
WALL = (1.0, 0.5, 1.0, 1.5)


def see(match: Match, *poses: tuple[float, float, float], walls=()) -> None:
    """Robots 0, 1 and so on stand so."""
    match.referee.see(Moment(match.now, tuple(walls), dict(enumerate(poses))), (WIDTH, HEIGHT))


def kept(match: Match) -> list[tuple[float, str, dict[str, Any]]]:
    """What was decided since the last call, as it is kept."""
    return [(one.at, kind_of(one.event), to_json(one.event)) for one in match.referee.take_journal()]


def meets(match: Match) -> bool:
    """Robot 0 fires, and robot 1 receives its packet."""
    match.wait(1)
    assert match.referee.shot(0, match.now)
    match.now += 0.1
    return match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)


def test_operators_see_which_rules_do_nothing_as_nobody_knows_where_robots_are(new_match):
    match = new_match()
    of_place = {"fence", "hill", "pickups", "line_of_fire"}

    def idle() -> set[str]:
        return {name for name, rule in match.referee.overview(match.now)["rules"].items() if rule["idle"]}

    assert idle() == of_place
    see(match)  # an empty floor: it would be seen if one came
    assert idle() == set()
    match.wait(SEEN + 0.1)
    assert idle() == of_place


@pytest.fixture
def fire(new_match) -> Match:
    match = new_match(rules=Rules(light="coded", line_of_fire=2.0))
    match.start("ada", "bob")
    return match


@pytest.mark.parametrize(
    ("victim", "heading", "walls", "meets"),
    [
        ((2.0, 1.0), EAST, (), True),
        ((2.4, 1.0), EAST, (), True),
        ((2.8, 1.0), EAST, (), False),
        ((0.5, 0.3), NORTH, (), False),
        ((0.5, 1.7), NORTH, (), True),
        ((2.0, 1.0), WEST, (), False),
        ((2.0, 2.0), EAST, (), False),
        ((2.0, 1.4), EAST, (), True),
        ((2.0, 1.0), EAST, (WALL,), False),
        ((2.0, 1.0), EAST, ((1.0, 1.02, 1.0, 1.5),), True),
        ((2.0, 1.0), EAST, ((2.5, 0.0, 2.5, 2.0),), True),
        ((0.6, 1.0), WEST, (WALL,), True),
    ],
    ids=[
        *("ahead", "at the end of its reach", "too far", "behind its side", "ahead, northwards", "behind", "aside"),
        *("a little aside", "behind a wall", "half behind a wall", "before a wall", "touching"),
    ],
)
def test_light_meets_what_is_near_ahead_and_not_behind_a_wall(victim, heading, walls, meets):
    assert could_meet((0.5, 1.0, heading), (*victim, 0.0), walls, 2.0) is meets


def test_a_hit_counts_only_if_the_shooter_can_have_fired_it_from_there(fire):
    match = fire
    match.wait(1)
    see(match, (0.5, 1, EAST), (2.0, 1, EAST))
    assert match.referee.shot(0, match.now)
    assert match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)
    match.wait(2)
    see(match, (0.5, 1, WEST), (2.0, 1, EAST))
    assert match.referee.shot(0, match.now)
    assert not match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)
    assert (match.player("bob").life, match.player("ada").hits) == (90, 1)


def test_a_hit_that_the_line_of_fire_refuses_is_an_event(fire):
    see(fire, (0.5, 1, WEST), (2.0, 1, EAST))
    assert not meets(fire)
    assert not fire.referee.shot_hit(1, 0, 0, fire.now, shots_told=True), "the same shot again"
    message, text = to_message(fire.state), public_status(fire.state)
    assert [(one.kind, one.name, one.by, one.life) for one in message.events] == [
        (GameEvent.REFUSED, "bob", "ada", 100)
    ]
    assert [one["kind"] for one in text["events"]] == [GameEvent.REFUSED]
    recorded = kept(fire)
    assert [kind for _, kind, _ in recorded].count("HitRefused") == 1
    _, bob = courses(recorded)
    assert [change[1:] for change in bob.changes] == [("refused", 100, "ada")]
    assert bob.hits == 0


def test_refused_hits_push_no_hit_out_of_what_is_told():
    state = State()
    state.robots.put(1, "raspberrypi1", 0.0)
    state.users.add_user(User("bob", 1, "session", 0, seen=0.0))
    for life in (90, 80):
        changes.apply(state, events.Hit("bob", 1, life, "ada"), 1.0)
    for _ in range(3 * TOLD):
        changes.apply(state, place_events.HitRefused("bob", 1, 80, "ada"), 1.0)
    told = state.happened
    assert [one.life for one in told if not one.refused] == [90, 80]
    newest = 2 + 3 * TOLD
    assert [one.number for one in told if one.refused] == [*range(newest - TOLD + 1, newest + 1)]
    for life in range(70, 70 - TOLD, -1):
        changes.apply(state, events.Hit("bob", 1, life, "ada"), 1.0)
    told = state.happened
    assert [one.life for one in told if not one.refused] == [*range(70, 70 - TOLD, -1)]
    assert [one.number for one in told] == sorted(one.number for one in told)


def test_a_hit_on_who_is_protected_anyway_is_not_told_as_refused(new_match):
    match = new_match(rules=Rules(light="coded", line_of_fire=2.0), protection=30)
    match.start("ada", "bob")
    match.wait(1)
    see(match, (0.5, 1, WEST), (2.0, 1, EAST))
    assert not meets(match)
    assert match.state.happened == ()


def test_a_robot_that_has_turned_away_since_its_shot_has_fired_it(fire):
    match = fire
    match.wait(1)
    see(match, (0.5, 1, EAST), (2.0, 1, EAST))
    assert match.referee.shot(0, match.now)
    match.now += REMEMBERED - 0.5
    see(match, (0.5, 1, WEST), (2.0, 1, EAST))
    assert match.referee.shot_hit(1, 0, 0, match.now, shots_told=True)


def test_without_the_rule_or_without_places_light_counts_from_anywhere(new_match, fire):
    assert meets(fire), "nobody has told where they are"
    see(fire, (0.5, 1, WEST), (2.0, 1, EAST))
    fire.wait(2 * REMEMBERED)
    assert meets(fire), "nobody tells any more"
    free = new_match(rules=Rules(light="coded"))
    free.start("ada", "bob")
    free.wait(1)
    see(free, (0.5, 1, WEST), (2.0, 1, EAST))
    assert free.referee.shot(0, free.now)
    assert free.referee.shot_hit(1, 0, 0, free.now, shots_told=True)


@pytest.mark.parametrize(
    ("pose", "sides"),
    [
        ((2.0, 1.0, EAST), Sides()),
        ((3.93, 1.0, EAST), Sides(ahead=True)),
        ((3.93, 1.0, WEST), Sides(behind=True)),
        ((3.93, 1.0, NORTH), Sides()),
        ((0.07, 1.0, WEST), Sides(ahead=True)),
        ((2.0, 0.05, NORTH), Sides(behind=True)),
        ((2.0, 1.95, NORTH), Sides(ahead=True)),
        ((0.05, 0.05, math.radians(-45)), Sides(ahead=True, behind=True)),
        ((4.5, 1.0, EAST), Sides(ahead=True)),
    ],
)
def test_at_the_edge_a_robot_may_not_drive_out(pose, sides):
    assert beyond(pose, WIDTH, HEIGHT) == sides


@pytest.fixture
def fenced(new_match) -> Match:
    match = new_match(rules=Rules(fence=True))
    match.start("ada", "bob")
    return match


def test_who_comes_to_the_edge_is_stopped_and_whoever_turns_is_free(fenced):
    see(fenced, (3.9, 1, EAST), (2, 1, EAST))
    see(fenced, (3.93, 1, EAST), (2, 1, EAST))
    assert [user.fence for user in to_message(fenced.state).users] == [1, 0]
    see(fenced, (3.93, 1, WEST), (2, 1, EAST))
    assert fenced.player("ada").fence == Sides(behind=True)
    see(fenced, (3.93, 1, NORTH), (2, 1, EAST))
    told = [str(one.event) for one in fenced.referee.take_journal() if "edge" in str(one.event)]
    assert told == [
        "ada (robot 0) is at the floor's edge and cannot drive on forwards",
        "ada (robot 0) is at the floor's edge and cannot drive on backwards",
        "ada (robot 0) is clear of the floor's edge",
    ]


def test_a_place_that_is_seen_a_little_elsewhere_each_time_is_one_event(fenced):
    for millimetres in (0, 7, -3, 4, -1, 6, -2):
        see(fenced, (3.908 - millimetres / 1000, 1, EAST + millimetres / 100), (2, 1, EAST))
    assert fenced.player("ada").fence == Sides(ahead=True)
    assert len([one for one in fenced.referee.take_journal() if "edge" in str(one.event)]) == 1
    see(fenced, (3.88, 1, EAST), (2, 1, EAST))
    assert fenced.player("ada").fence == Sides()


def test_without_the_rule_nobody_is_stopped(match):
    match.start("ada", "bob")
    see(match, (3.93, 1, EAST), (2, 1, EAST))
    assert match.player("ada").fence == Sides()


@pytest.mark.parametrize("how", ["not seen", "nothing is seen"])
def test_nobody_is_held_by_what_nobody_sees(fenced, how):
    see(fenced, (3.93, 1, EAST), (2, 1, EAST))
    assert fenced.player("ada").fence == Sides(ahead=True)
    if how == "not seen":
        fenced.referee.see(Moment(fenced.now, (), {1: (2, 1, EAST)}), (WIDTH, HEIGHT))
    else:
        fenced.wait(SEEN - 0.1)
        assert fenced.player("ada").fence == Sides(ahead=True)
        fenced.wait(0.2)
    assert fenced.player("ada").fence == Sides()


def test_a_battle_with_a_fence_can_be_played_again(fenced):
    see(fenced, (3.93, 1, EAST), (2, 1, EAST))
    fenced.hit("bob", 10)
    assert [placing.name for placing in replay(fenced.referee.take_journal())] == ["ada", "bob"]


HILL = Zone("middle", "hill", 2.0, 1.0, 0.3)
SPOTS = (Zone("left", "pick-up", 0.5, 1.0, 0.1), Zone("right", "pick-up", 3.5, 1.0, 0.1))
AWAY = (1.0, 0.2, EAST)


def new_game(rules: Rules, *names: str) -> Match:
    match = Match(rules=rules, zones=(HILL, *SPOTS))
    match.start(*names)
    return match


def stay(match: Match, seconds: float, *poses: tuple[float, float, float]) -> None:
    """Seen ten times a second."""
    for _ in range(round(seconds * 10)):
        match.wait(0.1)
        see(match, *poses)


def points(match: Match) -> dict[str, int]:
    return {player.name: player.points for player in match.state.players}


def test_a_second_alone_on_the_hill_is_a_point():
    match = new_game(Rules(hill=True), "ada", "bob")
    stay(match, 3.2, (2.2, 1, EAST), AWAY)
    assert points(match) == {"ada": 3, "bob": 0}
    stay(match, 5, (2.2, 1, EAST), (1.8, 1, EAST))
    assert points(match) == {"ada": 3, "bob": 0}, "both are on it"
    stay(match, 2.2, AWAY, (1.8, 1, EAST))
    assert points(match) == {"ada": 3, "bob": 2}


def test_a_team_holds_the_hill_together():
    match = new_game(Rules(hill=True, teams=2), "ada", "bob", "cy", "dee")
    teams = {player.name: player.team for player in match.state.players}
    on_hill = {name: (2.0, 1.0, EAST) if teams[name] == teams["ada"] else AWAY for name in teams}
    stay(match, 2.2, *(on_hill[name] for name in ("ada", "bob", "cy", "dee")))
    assert sorted(points(match).values()) == [0, 0, 0, 2]
    assert next(name for name, own in points(match).items() if own) in [
        name for name in teams if teams[name] == teams["ada"]
    ]


def test_who_has_held_the_hill_for_longest_wins_though_shot_down():
    match = new_game(Rules(hill=True), "ada", "bob", "cy")
    stay(match, 2.2, (2.2, 1, EAST), AWAY, AWAY)
    stay(match, 1.2, AWAY, (2.2, 1, EAST), AWAY)
    match.hit("ada", 10)
    match.hit("bob", 10)
    assert [(one.name, one.place, one.points) for one in match.state.result] == [
        ("ada", 1, 2),
        ("bob", 2, 1),
        ("cy", 3, 0),
    ]
    assert [one.name for one in replay(match.referee.take_journal())] == ["ada", "bob", "cy"]


def test_a_camera_that_is_away_gives_no_points():
    match = new_game(Rules(hill=True), "ada", "bob")
    see(match, (2.2, 1, EAST), AWAY)
    match.wait(30)
    see(match, (2.2, 1, EAST), AWAY)
    assert points(match) == {"ada": 0, "bob": 0}


def test_without_the_rule_or_in_a_pause_the_hill_is_only_floor():
    match = new_game(Rules(), "ada", "bob")
    stay(match, 2, (2.2, 1, EAST), AWAY)
    assert (points(match), match.state.places) == ({"ada": 0, "bob": 0}, ())
    match = new_game(Rules(hill=True), "ada", "bob")
    match.referee.operate(partial(desk.pause, by="eve"), match.now)
    stay(match, 2, (2.2, 1, EAST), AWAY)
    assert points(match) == {"ada": 0, "bob": 0}
    assert [one.kind for one in match.state.places] == ["hill"]


def lying(match: Match) -> dict[float, str]:
    """Kinds by x."""
    return {one.x: one.kind for one in match.state.places}


def test_pick_ups_come_after_a_time_to_every_place_that_is_empty():
    match = new_game(Rules(pickups=20), "ada", "bob")
    stay(match, 19, AWAY, AWAY)
    assert lying(match) == {}
    match.wait(1.1)
    assert lying(match) == {0.5: "repair", 3.5: "shield"}
    see(match, (0.55, 1, EAST), AWAY)
    assert lying(match) == {3.5: "shield"}
    match.wait(19)
    assert lying(match) == {3.5: "shield"}
    match.wait(1.1)
    assert lying(match) == {0.5: "shield", 3.5: "shield"}


@pytest.fixture
def laid() -> Match:
    """Repair to the left, a shield to the right; ada has life 40."""
    match = new_game(Rules(pickups=20), "ada", "bob")
    match.wait(20.1)
    match.hit("ada", 6)
    return match


def test_a_repair_gives_life_back_to_whoever_is_nearer(laid):
    see(laid, (0.52, 1, EAST), (0.58, 1, EAST))
    assert (laid.player("ada").life, laid.player("bob").life) == (70, 100)


def test_nobody_has_more_than_full_life(laid):
    see(laid, AWAY, (0.5, 1, EAST))
    assert laid.player("bob").life == 100


def test_a_shield_keeps_hits_away_for_a_while(laid):
    see(laid, (3.5, 1, EAST), AWAY)
    assert to_message(laid.state).users[-1].effects == 1
    laid.wait(7)
    assert laid.hit("ada") == [False]
    laid.wait(1.1)
    assert (laid.player("ada").effects, laid.hit("ada")) == ((), [True])


def test_double_damage_is_that_of_the_shooters_shots(new_match):
    match = new_game(Rules(pickups=20, light="coded"), "ada", "bob")
    for _ in range(2):
        match.wait(20.1)
        see(match, AWAY, (3.5, 1, EAST))
    assert match.player("bob").effects == ("double damage",)
    match.wait(1)
    assert match.referee.shot(1, match.now)
    assert match.referee.shot_hit(0, 1, 0, match.now, shots_told=True)
    assert match.player("ada").life == 80


def test_a_pause_takes_nothing_of_a_shield_and_brings_no_pick_up(laid):
    see(laid, (3.5, 1, EAST), AWAY)
    laid.referee.operate(partial(desk.pause, by="eve"), laid.now)
    laid.wait(60)
    laid.referee.operate(partial(desk.resume, by="eve"), laid.now)
    assert (laid.player("ada").effects, lying(laid)) == (("shield",), {0.5: "repair"})
    laid.wait(8.1)
    assert laid.player("ada").effects == ()


@pytest.mark.parametrize("paused", [False, True])
def test_points_shields_and_what_lies_there_outlive_the_program(laid, paused):
    see(laid, (3.5, 1, EAST), AWAY)
    if paused:
        laid.referee.operate(partial(desk.pause, by="eve"), laid.now)
    laid.restart(pause=3)
    assert (laid.player("ada").effects, lying(laid)) == (("shield",), {0.5: "repair"})
    if paused:
        laid.referee.operate(partial(desk.resume, by="eve"), laid.now)
    laid.wait(4.9)
    assert laid.player("ada").effects == ("shield",)
    laid.wait(3.2)
    assert laid.player("ada").effects == ()


def test_the_next_battle_begins_without_any_of_it(laid):
    see(laid, (3.5, 1, EAST), AWAY)
    laid.hit("bob", 10)
    assert lying(laid) == {}
    laid.ready("ada", "bob")
    laid.wait(16)
    assert (laid.state.game, laid.player("ada").effects, lying(laid)) == (2, (), {})
    assert laid.hit("ada") == [True]


def test_the_course_of_a_battle_tells_repairs_from_hits(laid):
    see(laid, (0.5, 1, EAST), AWAY)
    laid.hit("bob", 10)
    recorded = kept(laid)
    ada, bob = courses(recorded)
    assert (ada.hits, ada.life, [change.what for change in ada.changes][-2:]) == (6, 70, ["hit", "repair"])
    assert (bob.hits, bob.life) == (10, 0)


def test_the_course_of_a_battle_tells_who_takes_a_hill_and_not_each_second_on_it():
    match = new_game(Rules(hill=True), "ada", "bob")
    on_hill = (2.0, 1, EAST)
    for poses in ((on_hill, AWAY), (AWAY, on_hill), (on_hill, AWAY)):
        stay(match, 3.2, *poses)
    recorded = kept(match)
    ada, bob = courses(recorded)
    assert [[change[1:] for change in course.changes] for course in (ada, bob)] == [
        [("hill", 100, "")] * 2,
        [("hill", 100, "")],
    ]
    told = points_of_hills(recorded)
    assert [(one["name"], one["points"]) for one in told][:4] == [("ada", 1), ("ada", 2), ("ada", 3), ("bob", 1)]
    assert told[0]["at"] == pytest.approx(ada.changes[0].at)


def test_a_team_takes_a_hill_once():
    fighters = [{"name": name, "robot": robot, "avatar": 0, "team": 1} for robot, name in enumerate(("ada", "bob"))]
    held = [
        (101.0 + second, "HillHeld", {"name": name, "x": 2.0, "y": 1.0, "points": 1})
        for second, name in enumerate(("ada", "bob"))
    ]
    ada, bob = courses([(100.0, "BattleStarted", {"fighters": fighters}), *held])
    assert [change.what for change in (*ada.changes, *bob.changes)] == ["hill"]


def test_the_course_of_a_battle_tells_who_is_stopped_at_the_edge_once(fenced):
    for x in (0.05, 0.5, 0.05, 0.5):
        fenced.wait(1)
        see(fenced, (x, 1, WEST), (2, 1, WEST))
    ada, bob = courses(kept(fenced))
    assert [change[1:] for change in ada.changes] == [("fence", 100, "")]
    assert bob.changes == []


def test_a_replay_knows_when_something_lay_where():
    match = new_game(Rules(pickups=20, hill=True), "ada", "bob")
    stay(match, 1.2, AWAY, AWAY)
    match.wait(20)
    see(match, AWAY, (0.5, 1, EAST))
    recorded = kept(match)
    assert [kind for _, kind, _ in recorded].count("HillOpened") == 1, "once a battle"
    found = marks(recorded)
    assert [(one["kind"], one["x"], one["radius"], one["since"] > 0, one["until"] is None) for one in found] == [
        (0, 2.0, 0.3, False, True),
        (1, 0.5, 0.1, True, False),
        (2, 3.5, 0.1, True, True),
    ]


def test_a_replay_knows_a_hill_of_which_an_older_server_told_only_who_held_it():
    match = new_game(Rules(hill=True), "ada", "bob")
    stay(match, 1.2, (2.0, 1, EAST), AWAY)
    assert len(marks(one for one in kept(match) if one[1] != "HillOpened")) == 1


def test_a_replay_knows_for_whom_what_was_picked_up_worked_when(laid):
    see(laid, (3.5, 1, EAST), (0.5, 1, EAST))
    laid.wait(9)
    (effect,) = effects(kept(laid))
    assert (effect["name"], effect["what"]) == ("ada", "shield"), "a repair has worked at once"
    assert effect["until"] - effect["since"] == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("kind", "data", "until"),
    [
        ("EffectEnded", {"name": "ada", "robot": 0, "kind": "shield"}, 7.0),
        ("EffectEnded", {"name": "ada", "robot": 0, "kind": "double damage"}, None),
        ("Left", {"name": "ada"}, 7.0),
        ("Unseated", {"name": "bob"}, None),
        ("RobotGone", {"robot": 0}, 7.0),
        ("BattleEnded", {}, 7.0),
    ],
)
def test_it_works_until_it_has_ended_or_its_fighter_is_gone(kind, data, until):
    shield = {"name": "ada", "robot": 0, "zone": "left", "kind": "shield", "seconds": 8.0}
    recorded = [(100.0, "BattleStarted", {}), (103.0, "PickedUp", shield), (105.0, "PickedUp", shield)]
    assert effects([*recorded, (107.0, kind, data)]) == [
        {"name": "ada", "what": "shield", "since": 3.0, "until": until}
    ]
