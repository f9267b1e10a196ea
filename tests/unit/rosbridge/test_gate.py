"""The rules of who may do what."""

import hashlib
import io
from typing import Any

import pytest

from laser_bot_battle import variables
from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.names import operator_ticket, session_digest, session_ticket
from laser_bot_battle.settings import SettingsError
from server.access.globs import Globs
from server.access.handshake import OwnPages
from server.access.identity import FOREIGN_GUEST, GUEST, OPERATOR, AttemptsError, session_identity
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import Publish
from server.rosbridge.gate import Gate
from server.websocket.requests import RequestError

AL, BO = session_identity("token-of-al"), session_identity("token-of-bo")
# serialized: linear_x, angular_z, shoot
FORWARD, BACK, SHOT, NEUTRAL = b"\x01\x00\x00", b"\xff\x00\x00", b"\x00\x00\x01", b"\x00\x00\x00"
COMMAND = "laser_bot_battle/Robot_msg"
STOPPED, COUNTDOWN, PLAYING = GameStatus.STOPPED, GameStatus.COUNTDOWN, GameStatus.PLAYING


def user(name: str, robot: int, **fields: Any) -> UserStatus:
    session = hashlib.sha256(f"token-of-{name}".encode()).hexdigest()
    return UserStatus(**{"name": name, "robot": robot, "session": session, "life": 100, "ready": True, **fields})


NOON = 1_800_000_000.0  # Unix time, s


def gate(game: int = PLAYING, *users: UserStatus, result: tuple[UserStatus, ...] = ()) -> Gate:
    new = Gate("operator token", clock=lambda: NOON)
    users = users or (user("al", 0), user("bo", 1))
    new.update(GameStatus(game=game, users=list(users), result=list(result)), 0.0)
    return new


def test_a_living_ready_player_drives_their_own_robot_in_a_battle() -> None:
    assert gate().refuses_publishing(AL, "/Robot0/command", 0.0) == ""
    assert gate().refuses_publishing(BO, "/Robot1/command", 0.0) == ""


def test_practice_is_driving_while_no_battle_runs() -> None:
    rules = gate(STOPPED)
    for game, practice, may in (
        (STOPPED, True, True),
        (STOPPED, False, False),
        (COUNTDOWN, True, False),
        (PLAYING, True, False),
    ):
        al = user("al", 0, ready=False)
        rules.update(GameStatus(game=game, practice=practice, users=[al]), 0.0)
        assert (rules.refuses_publishing(AL, "/Robot0/command", 0.0) == "") is may, (game, practice)
        assert rules.refuses_publishing(BO, "/Robot1/command", 0.0) != "", "no player, no practice"


@pytest.mark.parametrize(
    ("fence", "ahead", "behind"),
    [
        (UserStatus.AHEAD, NEUTRAL, BACK),
        (UserStatus.BEHIND, FORWARD, NEUTRAL),
        (UserStatus.AHEAD | UserStatus.BEHIND, NEUTRAL, NEUTRAL),
        (0, FORWARD, BACK),
    ],
)
@pytest.mark.parametrize("game", [PLAYING, STOPPED])
def test_at_the_floors_edge_a_robot_turns_and_shoots_but_does_not_drive_on(
    fence: int, ahead: bytes, behind: bytes, game: int
) -> None:
    rules = gate(game, user("al", 0, fence=fence), user("bo", 1))
    assert (rules.granted(AL, FORWARD), rules.granted(AL, BACK)) == (ahead, behind)
    assert rules.granted(AL, b"\x01\xff\x01")[1:] == b"\xff\x01"
    assert rules.granted(AL, SHOT) == SHOT
    assert rules.granted(BO, FORWARD) == rules.granted(OPERATOR, FORWARD) == FORWARD


def test_beside_a_battle_of_others_one_drives_where_the_rule_says_so_but_does_not_shoot() -> None:
    rules = gate(STOPPED)
    al, bo, cy = user("al", 0, ready=False), user("bo", 1), user("cy", 2, life=0)
    for game, beside, may in ((PLAYING, True, True), (PLAYING, False, False), (COUNTDOWN, True, False)):
        rules.update(GameStatus(game=game, practice_beside=beside, users=[al, bo, cy]), 0.0)
        assert (rules.refuses_publishing(AL, "/Robot0/command", 0.0) == "") is may, (game, beside)
    rules.update(GameStatus(game=PLAYING, practice_beside=True, users=[al, bo, cy]), 0.0)
    assert "dead" in rules.refuses_publishing(session_identity("token-of-cy"), "/Robot2/command", 0.0)
    rules.update(
        GameStatus(game=PLAYING, practice_beside=True, users=[user("al", 0, ready=False, life=0), bo, cy]), 0.0
    )
    assert rules.refuses_publishing(AL, "/Robot0/command", 0.0) == "", "the battle before counts no more"
    assert rules.granted(AL, SHOT) == NEUTRAL
    assert rules.granted(AL, FORWARD) == FORWARD
    assert rules.granted(BO, SHOT) == SHOT
    assert rules.granted(OPERATOR, SHOT) == SHOT
    rules.update(GameStatus(game=STOPPED, practice=True, users=[al, bo, cy]), 0.0)
    assert rules.granted(AL, SHOT) == SHOT, "without a battle it disturbs nobody"
    rules.update(GameStatus(game=PLAYING, practice_beside=True, paused=True, users=[al, bo, cy]), 0.0)
    assert "paused" in rules.refuses_publishing(AL, "/Robot0/command", 0.0)


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
    "topic", ["/Robot1/command", "/Robot00/command", "/Robot0/command/x", "/Robot0/response", "/positions", "/x"]
)
def test_a_player_publishes_nowhere_else(topic: str) -> None:
    assert gate().refuses_publishing(AL, topic, 0.0)
    assert gate().refuses_advertising(AL, topic, COMMAND)


@pytest.mark.parametrize("game", [PLAYING, COUNTDOWN, STOPPED])
def test_nobody_drives_in_a_pause_but_operators(game: int) -> None:
    rules = gate()
    rules.update(GameStatus(game=game, users=[user("al", 0)], paused=True), 0.0)
    assert rules.refuses_publishing(AL, "/Robot0/command", 0.0)
    assert rules.refuses_publishing(OPERATOR, "/Robot0/command", 0.0) == ""
    rules.update(GameStatus(game=PLAYING, users=[user("al", 0)]), 0.0)
    assert rules.refuses_publishing(AL, "/Robot0/command", 0.0) == ""


def test_a_pause_stops_the_wheels() -> None:
    rules, drivers = gate(), Drivers()
    drivers.commanded("client", AL, "/Robot0/command", FORWARD)
    assert drivers.stop_refused(rules, 0.0) == []
    rules.update(GameStatus(game=PLAYING, users=[user("al", 0)], paused=True), 0.0)
    assert drivers.stop_refused(rules, 0.0) == [Publish("/Robot0/command", NEUTRAL)]


def test_a_robot_that_is_out_of_service_is_for_operators() -> None:
    """Its player waits for another one, and so is none."""
    rules, drivers = gate(), Drivers()
    drivers.commanded("client", AL, "/Robot0/command", FORWARD)
    rules.update(GameStatus(game=PLAYING, users=[user("bo", 1)], queue=["al"]), 0.0)
    assert drivers.stop_refused(rules, 0.0) == [Publish("/Robot0/command", NEUTRAL)]
    assert rules.refuses_publishing(AL, "/Robot0/command", 0.0)
    assert rules.refuses_publishing(OPERATOR, "/Robot0/command", 0.0) == ""


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
    assert not rules.refuses_offering(OPERATOR, "/add_new_robot")
    rules.check_command(OPERATOR, b"\x05\x80\x01")


def test_what_the_globs_leave_out_is_refused_to_operators_too() -> None:
    rules = Gate("", Globs(topics=("/scan*",), services=("/get_*",)))
    for topic, is_hidden in (("/scan", False), ("/scan/raw", False), ("/cmd_vel", True)):
        assert ("TOPICS_GLOB" in rules.refuses_publishing(OPERATOR, topic, 0.0)) is is_hidden
        assert ("TOPICS_GLOB" in rules.refuses_advertising(OPERATOR, topic, "std_msgs/String")) is is_hidden
        assert ("TOPICS_GLOB" in rules.refuses_subscribing(OPERATOR, topic, "")) is is_hidden
    for service, is_hidden in (("/get_plan", False), ("/reset", True)):
        assert ("SERVICES_GLOB" in rules.refuses_calling(OPERATOR, service)) is is_hidden
        assert ("SERVICES_GLOB" in rules.refuses_offering(OPERATOR, service)) is is_hidden


@pytest.mark.parametrize("linear", [-1, 0, 1])
@pytest.mark.parametrize("angular", [-1, 0, 1])
@pytest.mark.parametrize("shoot", [0, 1])
def test_players_have_keys_for_these_commands(linear: int, angular: int, shoot: int) -> None:
    gate().check_command(AL, bytes([linear % 256, angular % 256, shoot]))


@pytest.mark.parametrize("command", [b"\x05\x00\x00", b"\xfe\x00\x00", b"\x00\x02\x01", b"\x00\x80\x00"])
def test_a_player_is_no_faster_than_the_keys(command: bytes) -> None:
    with pytest.raises(RequestError, match=r"must be -1, 0 or 1, not -?\d+ and -?\d+$"):
        gate().check_command(AL, command)


def test_the_operators_token_is_compared_whole() -> None:
    assert gate().is_operator_token("operator token", "10.0.0.1", 0.0)
    for wrong in ("", "operator", "operator token ", "\ud800", "ö"):
        assert not gate().is_operator_token(wrong, "10.0.0.1", 0.0)
    assert not Gate("").is_operator_token("", "10.0.0.1", 0.0)


def test_a_ticket_of_the_operators_token_is_as_good_for_a_while() -> None:
    ticket = operator_ticket("operator token", NOON)
    assert gate().is_operator_token(ticket, "10.0.0.1", 0.0)
    for wrong in (
        operator_ticket("another token", NOON),
        operator_ticket("operator token", NOON - 21),
        session_ticket("operator token", NOON),
        ticket.replace(ticket[0], "9", 1),
        ticket[:-1],
        "",
    ):
        assert not gate().is_operator_token(wrong, "10.0.0.1", 0.0)
    assert not Gate("", clock=lambda: NOON).is_operator_token(operator_ticket("", NOON), "10.0.0.1", 0.0)


def test_who_guesses_the_operators_token_is_slowed_down_and_nobody_who_knows_it() -> None:
    rules = gate()
    for guess in range(5):
        assert not rules.is_operator_token(f"guess {guess}", "10.0.0.1", 0.0)
    for now in (0.0, 0.9):
        with pytest.raises(AttemptsError, match="too many wrong operator tokens"):
            rules.is_operator_token("guess", "10.0.0.1", now)
        assert rules.is_operator_token("operator token", "10.0.0.1", now)
        assert rules.is_operator_token(operator_ticket("operator token", NOON), "10.0.0.1", now)
    assert not rules.is_operator_token("guess", "10.0.0.2", 0.9)
    assert not rules.is_operator_token("one more", "10.0.0.1", 1.0)
    with pytest.raises(AttemptsError):
        rules.is_operator_token("and another", "10.0.0.1", 1.0)


def test_the_memory_of_guesses_is_bounded() -> None:
    rules = gate()
    for number in range(1001):
        for _ in range(5):
            rules.is_operator_token("guess", f"10.0.{number // 256}.{number % 256}", 0.0)
    assert not rules.is_operator_token("guess", "10.0.0.0", 0.0)
    with pytest.raises(AttemptsError):
        rules.is_operator_token("guess", "10.0.3.232", 0.0)


TICKET = session_ticket(session_digest("token-of-al"), NOON - 59)


def test_a_player_proves_who_it_is_by_token_or_ticket() -> None:
    assert gate().proven("al", "token-of-al") == AL
    assert gate().proven("al", TICKET) == AL


@pytest.mark.parametrize(
    ("name", "secret"),
    [
        ("bo", "token-of-al"),
        ("bo", TICKET),
        ("nobody", TICKET),
        ("al", session_digest("token-of-al")),
        ("al", session_ticket(session_digest("token-of-al"), NOON - 61)),
        ("al", session_ticket("", NOON)),
        ("al", TICKET.replace("1", "2", 1)),
        ("al", TICKET[:-1]),
        ("al", TICKET + "0"),
        *[("al", f"{end}.{TICKET.partition('.')[2]}") for end in ("", "x", "-1", "1" * 5000, "١", "1e9", "\ud800")],
        *[("al", secret) for secret in ("", ".", "ö", "\ud800", "a.b.c")],
    ],
    ids=ascii,
)
def test_nothing_else_is_a_proof(name: str, secret: str) -> None:
    assert gate().proven(name, secret) is None


def test_clients_do_not_learn_by_what_players_are_known() -> None:
    status = GameStatus(game=PLAYING, notice="n", users=[user("al", 0), user("bo", 1)], result=[user("cy", 2)])
    buffer = io.BytesIO()
    status.serialize(buffer)
    told = GameStatus().deserialize(Gate.public(buffer.getvalue()))
    for one in (*status.users, *status.result):
        one.session = ""
    assert told == status


def test_players_call_and_offer_no_services_and_watch_only_the_battle() -> None:
    assert gate().refuses_calling(AL, "/add_new_robot")
    assert gate().refuses_offering(AL, "/add_new_robot")
    assert gate().refuses_subscribing(AL, "/Robot1/command", COMMAND)
    for who in (AL, GUEST):
        assert gate().refuses_subscribing(who, "/game_status", "") == ""
        assert gate().refuses_subscribing(who, "/positions", "laser_bot_battle/Positions") == ""
        assert gate().refuses_subscribing(who, "/shots", "") == ""
        assert "is of type" in gate().refuses_subscribing(who, "/positions", "laser_bot_battle/Shot")


def test_players_ask_the_time_to_measure_their_link_and_guests_do_not() -> None:
    assert gate().refuses_calling(AL, "/rosapi/get_time") == ""
    assert "signed-in players" in gate().refuses_calling(GUEST, "/rosapi/get_time")
    assert "only operators" in gate().refuses_calling(AL, "/rosapi/get_param")


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


HOST = "laser_bot_master.local:9090"
COOKIE = ["laserbot_session=token-of-al"]
ORIGINS = {"LASERBOT_ORIGINS": " https://ARENA.example\nhttp://old.example:8080"}
PAGES = OwnPages(5000, variables.ORIGINS.read(ORIGINS), ["Master.Hall.Example"])


@pytest.mark.parametrize(
    "cookies",
    [
        COOKIE,
        ["a=b; laserbot_session=token-of-al; c"],
        ["a=b", 'laserbot_session="token-of-al"'],
        ["laserbot_session=token-of-al; laserbot_session=other"],
        ["laserbot_session=other; __Secure-laserbot_session=token-of-al"],
    ],
)
def test_the_cookie_tells_who_it_is(cookies: list[str]) -> None:
    assert PAGES.identity_of(None, HOST, cookies) == AL
    assert PAGES.identity_of("http://laser_bot_master.local:5000", HOST, cookies) == AL


@pytest.mark.parametrize("cookies", [[], [""], ["laserbot_session="], ["laserbot_session"], ["xlaserbot_session=x"]])
def test_without_our_cookie_it_is_anybody(cookies: list[str]) -> None:
    assert PAGES.identity_of(None, HOST, cookies) == GUEST


@pytest.mark.parametrize(
    ("origin", "host"),
    [
        ("https://LASER_bot_master.local:5000", HOST),
        ("http://localhost:5000", "localhost:9090"),
        ("http://192.168.1.7:5000", "192.168.1.7:9090"),
        ("http://[fe80::1]:5000", "[fe80::1]:9090"),
        ("http://[::ffff:10.0.0.1]:5000", "[::ffff:10.0.0.1]:9090"),
        ("http://master:5000", "MASTER"),
        ("http://master.hall.example:5000", "master.hall.example:9090"),
        ("https://arena.example", "arena.example"),
        ("https://arena.example:443", "rosbridge.arena.example"),
        ("http://old.example:8080", None),
        # one address for all, by a proxy before the game; rosbridge itself has no pages
        ("http://laser_bot_master.local:9090", HOST),
        ("http://laser_bot_master.local", "laser_bot_master.local"),
        ("https://192.168.1.7", "192.168.1.7"),
        ("http://localhost:8000", "localhost:8000"),
    ],
)
def test_these_are_pages_of_the_game(origin: str, host: str | None) -> None:
    assert PAGES.identity_of(origin, host, COOKIE) == AL


@pytest.mark.parametrize(
    ("origin", "host"),
    [
        ("http://laser_bot_master.local:8080", HOST),  # another program's page on the same machine
        ("http://laser_bot_master.local", HOST),
        ("https://laser_bot_master.local", HOST),
        ("ftp://laser_bot_master.local:5000", HOST),
        ("chrome-extension://laser_bot_master.local:5000", HOST),
        ("http://laser_bot_master.local:5000", None),
        ("http://laser_bot_master.local:5000", "other.local:9090"),
        ("http://other.local:5000", HOST),
        ("http://evil.example", "evil.example"),
        ("http://192.168.1.7", "192.168.1.7:8000"),
        ("https://192.168.1.7", "192.168.1.7:80"),
        ("http://evil.example:5000", "evil.example:9090"),  # whose DNS says that it is this machine
        ("http://1.2.3.4.evil.example:5000", "1.2.3.4.evil.example:9090"),
        ("http://127.0.0.1.:5000", "127.0.0.1.:9090"),
        ("http://arena.example", "arena.example"),
        ("https://arena.example:5001", "arena.example"),
        ("http://laser_bot_master.local.evil.example:5000", HOST),
        ("http://laser_bot_master.local@evil.example:5000", HOST),
        ("http://laser_bot_master.local:5000@evil.example", HOST),
        ("http://laser_bot_master.local:5000/", HOST),
        ("http://laser_bot_master.local:5000\n", HOST),
        ("http://laser_bot_master.local:" + "5" * 5000, HOST),
        ("http://laser_bot_master.local:٥٠٠٠", HOST),
        ("http://laser_bot_master.local:05000 ", HOST),
        ("http://laser_bot_master.local:5000", "laser_bot_master.local:" + "9" * 5000),
        *[(rubbish, HOST) for rubbish in ("", "null", "*", "http://", "http://[", "//", "laser_bot_master.local:5000")],
    ],
    ids=lambda value: ascii(value)[:60],
)
def test_other_pages_do_not_act_for_the_player(origin: str, host: str | None) -> None:
    assert PAGES.identity_of(origin, host, COOKIE) == FOREIGN_GUEST


def test_a_web_server_on_the_usual_port_has_pages_without_a_port() -> None:
    assert OwnPages(80).identity_of("http://master", "master:9090", COOKIE) == AL
    assert OwnPages(443).identity_of("https://master", "master:9090", COOKIE) == AL
    assert OwnPages(80).identity_of("https://master", "master:9090", COOKIE) == FOREIGN_GUEST


@pytest.mark.parametrize(
    "word", ["arena.example", "https://arena.example/", "ws://a", "https://*", "http://a:" + "1" * 6]
)
def test_an_address_that_is_none_is_named(word: str) -> None:
    with pytest.raises(SettingsError, match=r"^LASERBOT_ORIGINS=.* is not http://host"):
        variables.ORIGINS.read({"LASERBOT_ORIGINS": f"http://fine {word}"})
