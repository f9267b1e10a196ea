"""The rules of who may do what."""

import hashlib
from typing import Any

import pytest

from laser_bot_battle.msg import GameStatus, Robot_msg, UserStatus
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import Publish
from server.rosbridge.gate import GUEST, OPERATOR, Gate, session_identity
from server.rosbridge.handshake import identity_of

AL, BO = session_identity("token-of-al"), session_identity("token-of-bo")
FORWARD, SHOT, NEUTRAL = Robot_msg(1, 0, False), Robot_msg(0, 0, True), Robot_msg(0, 0, False)
COMMAND = "laser_bot_battle/Robot_msg"
STOPPED, COUNTDOWN, PLAYING = GameStatus.STOPPED, GameStatus.COUNTDOWN, GameStatus.PLAYING


def user(name: str, robot: int, **fields: Any) -> UserStatus:
    session = hashlib.sha256(f"token-of-{name}".encode()).hexdigest()
    return UserStatus(**{"name": name, "robot": robot, "session": session, "life": 100, "ready": True, **fields})


def gate(game: int = PLAYING, *users: UserStatus, result: tuple[UserStatus, ...] = ()) -> Gate:
    new = Gate("operator token")
    users = users or (user("al", 0), user("bo", 1))
    new.update(GameStatus(game=game, users=list(users), result=list(result)), 0.0)
    return new


def test_a_living_ready_player_drives_their_own_robot_in_a_battle() -> None:
    assert gate().refuses_publishing(AL, "/Robot0/command", 0.0) == ""
    assert gate().refuses_publishing(BO, "/Robot1/command", 0.0) == ""


@pytest.mark.parametrize(
    ("rules", "reason"),
    [
        (gate(STOPPED), "no battle is running"),
        (gate(COUNTDOWN), "no battle is running"),
        (gate(PLAYING, user("al", 0, life=0)), "dead"),
        (gate(PLAYING, user("al", 0, ready=False)), "not in this battle"),
        (gate(PLAYING, user("bo", 0)), "only signed-in players"),
        (gate(PLAYING, user("al", 10)), "al may publish on /Robot10/command only"),
        (gate(PLAYING, user("al", 0, session="")), "only signed-in players"),
        (gate(PLAYING, user("bo", 1), result=(user("al", 0),)), "only signed-in players"),
        (Gate(""), "only signed-in players"),
    ],
)
def test_a_player_does_not_drive_otherwise(rules: Gate, reason: str) -> None:
    assert reason in rules.refuses_publishing(AL, "/Robot0/command", 0.0)


@pytest.mark.parametrize(
    "topic", ["/Robot1/command", "/Robot00/command", "/Robot0/command/x", "/Robot0/response", "/x"]
)
def test_a_player_publishes_nowhere_else(topic: str) -> None:
    assert gate().refuses_publishing(AL, topic, 0.0)
    assert gate().refuses_advertising(AL, topic, COMMAND)


def test_a_player_advertises_their_own_robot_before_the_battle_too() -> None:
    assert gate(STOPPED).refuses_advertising(AL, "/Robot0/command", COMMAND) == ""
    assert "is of type" in gate(STOPPED).refuses_advertising(AL, "/Robot0/command", "std_msgs/String")


def test_guests_are_no_session_even_if_a_user_has_none() -> None:
    rules = gate(PLAYING, user("al", 0, session=""))
    assert rules.refuses_publishing(GUEST, "/Robot0/command", 0.0)
    assert rules.refuses_advertising(GUEST, "/Robot0/command", COMMAND)


def test_nobody_drives_when_the_referee_is_silent() -> None:
    assert gate().refuses_publishing(AL, "/Robot0/command", 3.0) == ""
    assert "referee" in gate().refuses_publishing(AL, "/Robot0/command", 3.1)


def test_operators_do_everything() -> None:
    rules = gate(STOPPED)
    assert not rules.refuses_publishing(OPERATOR, "/anything", 99.0)
    assert not rules.refuses_advertising(OPERATOR, "/anything", "std_msgs/String")
    assert not rules.refuses_subscribing(OPERATOR, "/anything", "")
    assert not rules.refuses_calling(OPERATOR, "/add_new_robot")


def test_the_operators_token_is_compared_whole() -> None:
    assert gate().is_operator_token("operator token")
    for wrong in ("", "operator", "operator token ", "\ud800", "ö"):
        assert not gate().is_operator_token(wrong)


def test_players_call_no_services_and_watch_only_the_battle() -> None:
    assert gate().refuses_calling(AL, "/add_new_robot")
    assert gate().refuses_subscribing(AL, "/Robot1/command", COMMAND)
    assert gate().refuses_subscribing(AL, "/game_status", "") == ""


def test_a_moving_robot_stops_when_its_driver_is_gone() -> None:
    drivers = Drivers()
    for command in (FORWARD, SHOT):
        drivers.commanded("window", AL, "/Robot0/command", command)
        assert drivers.stop("another window") == []
        assert drivers.stop("window") == [Publish("/Robot0/command", NEUTRAL)]
        assert drivers.stop("window") == []


def test_a_standing_robot_is_left_alone() -> None:
    drivers = Drivers()
    drivers.commanded("window", AL, "/Robot0/command", FORWARD)
    drivers.commanded("window", AL, "/Robot0/command", NEUTRAL)
    assert drivers.stop("window") == []


def test_the_last_window_to_command_counts() -> None:
    drivers = Drivers()
    drivers.commanded("first", AL, "/Robot0/command", FORWARD)
    drivers.commanded("second", AL, "/Robot0/command", FORWARD)
    assert drivers.stop("first") == []
    assert drivers.stop("second") == [Publish("/Robot0/command", NEUTRAL)]


def test_robots_stop_when_the_right_to_drive_them_ends() -> None:
    drivers = Drivers()
    drivers.commanded("als", AL, "/Robot0/command", FORWARD)
    drivers.commanded("bos", BO, "/Robot1/command", FORWARD)
    drivers.commanded("ops", OPERATOR, "/Robot2/command", FORWARD)
    assert drivers.stop_refused(gate(), 0.0) == []
    assert drivers.stop_refused(gate(PLAYING, user("al", 0, life=0), user("bo", 1)), 0.0) == [
        Publish("/Robot0/command", NEUTRAL)
    ]
    assert drivers.stop_refused(gate(STOPPED), 0.0) == [Publish("/Robot1/command", NEUTRAL)]
    assert drivers.stop_all() == [Publish("/Robot2/command", NEUTRAL)]
    assert drivers.stop_all() == []


def test_only_command_topics_are_robots() -> None:
    drivers = Drivers()
    drivers.commanded("ops", OPERATOR, "/elsewhere", FORWARD)
    assert drivers.stop_all() == []


HOST = "laser_bot_master.local:9090"


@pytest.mark.parametrize(
    ("origin", "cookies"),
    [
        (None, ["laserbot_session=token-of-al"]),
        ("http://laser_bot_master.local:5000", ["laserbot_session=token-of-al"]),
        ("https://LASER_bot_master.local", ["a=b; laserbot_session=token-of-al; c"]),
        ("http://laser_bot_master.local", ["a=b", 'laserbot_session="token-of-al"']),
        (None, ["laserbot_session=token-of-al; laserbot_session=other"]),
    ],
)
def test_the_cookie_tells_who_it_is(origin: str | None, cookies: list[str]) -> None:
    assert identity_of(origin, HOST, cookies) == AL


@pytest.mark.parametrize(
    ("origin", "host"),
    [
        ("http://evil.example:9090", HOST),
        ("null", HOST),
        ("", HOST),
        ("http://[", HOST),
        ("http://laser_bot_master.local.evil.example", HOST),
        ("http://laser_bot_master.local@evil.example", HOST),
        ("http://laser_bot_master.local:5000", None),
        ("http://laser_bot_master.local:5000", "other.local:9090"),
    ],
)
def test_a_page_of_another_host_does_not_act_for_the_player(origin: str, host: str | None) -> None:
    assert identity_of(origin, host, ["laserbot_session=token-of-al"]) == GUEST


@pytest.mark.parametrize("cookies", [[], [""], ["laserbot_session="], ["laserbot_session"], ["xlaserbot_session=x"]])
def test_without_our_cookie_it_is_anybody(cookies: list[str]) -> None:
    assert identity_of(None, HOST, cookies) == GUEST
