"""The HTTP API: exact bodies for good input, clear JSON errors for bad input, and no change of state by it."""

import hashlib
import io
import json
import threading
import time
from typing import Any

import pytest

from laser_bot_battle.addresses import machine_of, own_addresses
from laser_bot_battle.names import is_session_ticket, key_digest
from server.game import events
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.site import whole_site

POST_ROUTES = (
    "/signUpUser",
    "/signOutUser",
    "/updateGameStatus",
    "/getAvailableRobots",
    "/playerReady",
    "/chooseTeam",
    "/incAlive",
    "/takeRobot",
    "/restarting",
)


class Site:
    """The application over a real battle with robots 0 to 2, whose time stands still; every browser has its cookies."""

    def __init__(self, robots: int = 3, **rules: Any) -> None:
        self.now = 1000.0
        self.battle = GameLoop(Referee(Rules(**rules)), clock=lambda: self.now)
        for _ in range(robots):
            add_linked_robot(self.battle)
        self.app = whole_site(self.battle, Settings.from_env({}))

    def browser(self):
        return self.app.test_client()


@pytest.fixture
def site() -> Site:
    return Site()


@pytest.fixture
def browser(site):
    return site.browser()


def body(response) -> dict:
    """The answer's JSON, which must come in the form that old pages expect."""
    assert response.content_type == "text/html; charset=utf-8"
    assert response.headers["Cache-Control"] == "no-store"
    content = json.loads(response.text)
    assert response.text == json.dumps(content, sort_keys=True)
    return content


def sign_up(browser, name, **fields):
    return body(browser.post("/signUpUser", data={"data": name, **fields}))


def players(site):
    return [player.name for player in site.battle.snapshot().players]


# signUpUser


def test_sign_up_gives_the_lowest_robot_and_a_session_cookie(site, browser):
    response = browser.post("/signUpUser", data={"data": "al"})
    assert response.status_code == 200
    assert response.text == '{"robot": 0, "status": "OK", "user": "al"}'
    cookie = response.headers["Set-Cookie"]
    assert cookie.startswith("laserbot_session=")
    assert {"HttpOnly", "Path=/", "SameSite=Lax"} <= set(cookie.split("; "))
    token = browser.get_cookie("laserbot_session").value
    assert len(token) >= 43
    assert site.battle.snapshot().players[0].session == hashlib.sha256(token.encode()).hexdigest()


def test_a_taken_name_is_unavailable(site, browser):
    site.browser().post("/signUpUser", data={"data": "al"})
    response = browser.post("/signUpUser", data={"data": "al"})
    assert response.text == '{"status": "UNAVAILABLE", "user": "al"}'
    assert "Set-Cookie" not in response.headers


def test_no_robots_left(browser):
    site = Site(robots=1)
    assert sign_up(site.browser(), "al")["status"] == "OK"
    assert sign_up(site.browser(), "bo") == {"status": "NO_ROBOTS", "user": "bo"}
    assert sign_up(site.browser(), "al") == {"status": "UNAVAILABLE", "user": "al"}


def test_a_wanted_robot_is_given_when_it_is_free(site):
    assert sign_up(site.browser(), "al", robot="1") == {"status": "OK", "robot": 1, "user": "al"}
    assert sign_up(site.browser(), "bo", robot="1") == {"status": "ROBOT_UNAVAILABLE", "robot": 1}
    assert sign_up(site.browser(), "bo", robot="77") == {"status": "ROBOT_UNAVAILABLE", "robot": 77}
    assert players(site) == ["al"]
    assert sign_up(site.browser(), "bo") == {"status": "OK", "robot": 0, "user": "bo"}


@pytest.mark.parametrize("wish", ["", "x", "1.0", " 1 ", "١"])
def test_a_wish_that_is_no_robot_is_refused(site, browser, wish):
    response = browser.post("/signUpUser", data={"data": "al", "robot": wish})
    assert response.status_code == 400
    assert json.loads(response.text) == {"error": "robot must be a whole number", "status": "ERROR"}
    assert players(site) == []


def test_refusals_are_logged(site, browser, caplog):
    with caplog.at_level("INFO"):
        browser.post("/signUpUser", data={"data": "<b>"})
        browser.post("/signUpUser")
        browser.post("/incAlive", data={"ID": "x"})
        sign_up(site.browser(), "al")
        browser.post("/signOutUser", data={"data": "al"})
        sign_up(browser, "al")
    assert [line for line in caplog.messages if "refused" in line or "taken" in line] == [
        "/signUpUser from 127.0.0.1 refused: a name is 1 to 16 letters, digits, _ and single spaces between them",
        "/signUpUser from 127.0.0.1 refused: the form field data is missing",
        "/incAlive from 127.0.0.1 refused: ID must be a whole number",
        "/signOutUser from 127.0.0.1 refused: only that user can sign out",
        "the name al is taken: 127.0.0.1 has to choose another",
    ]


def test_a_double_click_gets_the_same_robot_again_and_keeps_the_session(site, browser):
    first = sign_up(browser, "al")
    token = browser.get_cookie("laserbot_session").value
    assert sign_up(browser, "al") == first
    assert browser.get_cookie("laserbot_session").value == token
    assert players(site) == ["al"]


@pytest.mark.parametrize("avatar", range(5))
def test_the_avatar_is_kept(site, browser, avatar):
    sign_up(browser, "al", avatar=str(avatar))
    assert site.battle.snapshot().players[0].avatar == avatar


@pytest.mark.parametrize("avatar", ["5", "-1", "", "x", "1.0", " 1", "٣", "01"])
def test_an_impossible_avatar_is_refused(site, browser, avatar):
    response = browser.post("/signUpUser", data={"data": "al", "avatar": avatar})
    assert response.status_code == 400
    assert body(response) == {"error": "avatar must be 0 to 4", "status": "ERROR", "user": "al"}
    assert players(site) == []


@pytest.mark.parametrize(
    "name", ["", " ", "x" * 17, "a  b", " a", "a ", "a\n", "<img src=x onerror=alert(1)>", "a\u202eb", "\x00", "[]"]
)
def test_a_bad_name_is_refused_and_leaves_no_trace(site, browser, name):
    response = browser.post("/signUpUser", data={"data": name})
    assert response.status_code == 400
    assert response.content_type == "text/html; charset=utf-8"
    content = json.loads(response.text)
    assert content == {
        "error": "a name is 1 to 16 letters, digits, _ and single spaces between them",
        "status": "ERROR",
        "user": name,
    }
    assert "Set-Cookie" not in response.headers
    assert players(site) == []
    assert site.battle.snapshot().available_robots == 3


@pytest.mark.parametrize(
    "name",
    [
        "operator",
        "Admin",
        "REFEREE",
        "server",
        "master",
        "laserbot",
        "everybody",
        "nobody",
        "robot0",
        "Robot12",
        "Robot 12",
        "player 3",
        "ｒｏｂｏｔ７",
    ],
)
def test_a_reserved_name_is_refused(site, browser, name):
    response = browser.post("/signUpUser", data={"data": name})
    assert response.status_code == 400
    assert body(response) == {
        "error": f"the name {name} is reserved: choose another", "status": "ERROR", "user": name,
    }  # fmt: skip
    assert players(site) == []


@pytest.mark.parametrize(
    "name", ["robot", "robots", "robot1x", "operators", "admin_", "Bot1", "player3", "the operator"]
)
def test_a_name_that_only_looks_reserved_is_free(browser, name):
    assert sign_up(browser, name)["status"] == "OK"


def test_a_name_is_never_echoed_as_html(browser):
    for route, field in (("/signUpUser", "data"), ("/signOutUser", "data")):
        response = browser.post(route, data={field: "<script>alert('1')</script>"})
        assert "<" not in response.text
        assert "default-src 'none'" in response.headers["Content-Security-Policy"]
        assert json.loads(response.text)["user"] == "<script>alert('1')</script>"


def test_many_sign_up_with_one_name_at_the_same_instant(site):
    barrier = threading.Barrier(8)
    answers = []

    def click():
        browser = site.browser()
        barrier.wait()
        answers.append(sign_up(browser, "al")["status"])

    threads = [threading.Thread(target=click) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(answers) == ["OK"] + ["UNAVAILABLE"] * 7
    assert players(site) == ["al"]


@pytest.mark.parametrize(
    ("peer", "headers"),
    [
        ("10.0.0.7", {}),
        ("127.0.0.2", {}),
        ("10.0.0.7", {"X-Forwarded-For": "127.0.0.1"}),  # which it says of itself
        ("127.0.0.1", {"X-Forwarded-For": "9.9.9.9, 10.0.0.7"}),
        ("127.0.0.1", {"X-Forwarded-For": "nonsense"}),
        ("::1", {"X-Forwarded-For": "10.0.0.7"}),
        ("::ffff:10.0.0.7", {}),
        ("::ffff:127.0.0.1", {"X-Forwarded-For": "::ffff:10.0.0.7"}),
    ],
)
def test_an_address_signs_up_four_times_at_once_and_then_waits(peer, headers):
    site = Site(robots=8)

    def sign_up_from(name):
        return site.browser().post(
            "/signUpUser", data={"data": name}, headers=headers, environ_base={"REMOTE_ADDR": peer}
        )

    assert [body(sign_up_from(name))["status"] for name in "abcd"] == ["OK"] * 4
    refused = sign_up_from("e")
    assert refused.status_code == 429
    assert refused.headers["Retry-After"] == "3"
    assert body(refused) == {"error": "too many sign-ups from your address: again in 3 s", "status": "ERROR"}
    assert "Set-Cookie" not in refused.headers
    assert players(site) == ["a", "b", "c", "d"]
    other = site.browser().post("/signUpUser", data={"data": "e"}, environ_base={"REMOTE_ADDR": "10.0.0.8"})
    assert body(other)["status"] == "OK", "nobody else waits for it"


def test_bots_and_people_of_an_address_take_no_sign_ups_from_each_other():
    site = Site(robots=40)

    def sign_up_from(name):
        peer = {"REMOTE_ADDR": "10.0.0.7"}
        return site.browser().post("/signUpUser", data={"data": name}, environ_base=peer)

    assert [body(sign_up_from(f"Bot{number}"))["status"] for number in range(32)] == ["OK"] * 32
    assert sign_up_from("Bot32").status_code == 429
    assert [body(sign_up_from(name))["status"] for name in ("a", "Bot", "Botond", "Bot_1")] == ["OK"] * 4
    assert sign_up_from("e").status_code == 429


def test_an_address_of_ipv4_is_the_same_however_a_socket_calls_it():
    site = Site(robots=8)
    peers = [{"REMOTE_ADDR": peer} for peer in ("10.0.0.7", "::ffff:10.0.0.7", "::ffff:a00:7", "10.0.0.7")]
    for name, peer in zip("abcd", peers, strict=True):
        site.browser().post("/signUpUser", data={"data": name}, environ_base=peer)
    for peer in peers:
        assert site.browser().post("/signUpUser", data={"data": "e"}, environ_base=peer).status_code == 429


@pytest.mark.parametrize("peer", ["127.0.0.1", "::1", "::ffff:127.0.0.1"])
def test_who_plays_on_this_machine_never_waits(peer):
    site = Site(robots=8)
    for name in "abcdefgh":
        answer = site.browser().post("/signUpUser", data={"data": name}, environ_base={"REMOTE_ADDR": peer})
        assert body(answer)["status"] == "OK"


def test_a_slip_in_the_name_costs_no_sign_up(site):
    browser = site.browser()
    for _ in range(10):
        assert (
            browser.post("/signUpUser", data={"data": ""}, environ_base={"REMOTE_ADDR": "10.0.0.7"}).status_code == 400
        )
    assert sign_up(browser, "al")["status"] == "OK"


def test_one_visitor_has_one_robot(site, browser):
    for name in ("al", "bo", "cy"):
        assert sign_up(browser, name)["status"] == "OK"
    assert players(site) == ["cy"]


# signOutUser


def test_sign_out_frees_name_and_robot_and_the_cookie_goes(site, browser):
    sign_up(browser, "al")
    response = browser.post("/signOutUser", data={"data": "al"})
    assert response.text == '{"status": "OK", "user": "al"}'
    assert browser.get_cookie("laserbot_session") is None
    assert players(site) == []
    assert body(browser.post("/signOutUser", data={"data": "al"})) == {"status": "UNREGISTERED", "user": "al"}


@pytest.mark.parametrize("signed_in", [True, False])
def test_nobody_signs_another_out(site, browser, signed_in):
    site.browser().post("/signUpUser", data={"data": "al"})
    if signed_in:
        sign_up(browser, "bo")
    response = browser.post("/signOutUser", data={"data": "al"})
    assert response.status_code == 403
    content = body(response)
    assert content.pop("error")
    assert content == {"status": "FAILED", "user": "al"}
    assert "al" in players(site)


def test_a_forged_cookie_is_no_session(site, browser):
    site.browser().post("/signUpUser", data={"data": "al"})
    for value in ("", "x", site.battle.snapshot().players[0].session, "\xff\xfe", "a" * 4000):
        browser.set_cookie("laserbot_session", value)
        assert browser.post("/signOutUser", data={"data": "al"}).status_code == 403
        assert body(browser.get("/session")) == {"status": "UNREGISTERED"}
    assert players(site) == ["al"]


# playerReady


def test_player_ready(site, browser):
    sign_up(browser, "al")
    response = browser.post("/playerReady", data={"user": "al", "ready": "1"})
    assert response.text == '{"status": "OK", "user": "al"}'
    assert site.battle.snapshot().players[0].ready
    browser.post("/playerReady", data={"user": "al", "ready": "0"})
    assert not site.battle.snapshot().players[0].ready


@pytest.mark.parametrize("ready", ["2", "-1", "01", " 1 ", "1 ", "١", "x", "1.0", "", "true", "1\n"])
def test_ready_is_exactly_0_or_1(site, browser, ready):
    sign_up(browser, "al")
    response = browser.post("/playerReady", data={"user": "al", "ready": ready})
    assert response.status_code == 400
    assert body(response) == {"error": "ready must be 0 or 1", "status": "ERROR", "user": "al"}
    assert not site.battle.snapshot().players[0].ready


def test_an_unknown_user_cannot_get_ready(browser):
    response = browser.post("/playerReady", data={"user": "al", "ready": "1"})
    assert response.status_code == 200
    assert body(response) == {"status": "ERROR", "user": "al"}


def test_nobody_gets_another_ready(site, browser):
    site.browser().post("/signUpUser", data={"data": "al"})
    response = browser.post("/playerReady", data={"user": "al", "ready": "1"})
    assert response.status_code == 403
    content = body(response)
    assert content.pop("error")
    assert content == {"status": "ERROR", "user": "al"}
    assert not site.battle.snapshot().players[0].ready


def test_in_a_battle_everyone_gets_started_whatever_is_asked():
    site = Site(countdown=0.1)
    for name in ("al", "bo"):
        browser = site.browser()
        sign_up(browser, name)
        browser.post("/playerReady", data={"user": name, "ready": "1"})
    site.now += 0.1
    assert site.battle.snapshot().game == 2
    for user in ("al", "bo", "nobody"):
        for ready in ("0", "1", "x"):
            response = site.browser().post("/playerReady", data={"user": user, "ready": ready})
            assert (response.status_code, response.text) == (200, '{"status": "STARTED"}')
    assert [player.ready for player in site.battle.snapshot().players] == [True, True]


def test_where_late_comers_may_join_only_who_can_gets_ok():
    site = Site(countdown=0.1, late_join=True)
    al, bo, cy = (site.browser() for _ in range(3))
    for browser, name in ((al, "al"), (bo, "bo")):
        sign_up(browser, name)
        browser.post("/playerReady", data={"user": name, "ready": "1"})
    site.now += 0.1
    assert site.battle.snapshot().game == 2
    sign_up(cy, "cy")
    assert body(cy.post("/playerReady", data={"user": "cy", "ready": "0"})) == {"status": "STARTED"}
    assert body(al.post("/playerReady", data={"user": "cy", "ready": "1"})) == {"status": "STARTED"}
    assert body(cy.post("/playerReady", data={"user": "cy", "ready": "1"})) == {"status": "OK", "user": "cy"}
    assert body(al.post("/playerReady", data={"user": "al", "ready": "1"})) == {"status": "STARTED"}
    assert [player.ready for player in site.battle.snapshot().players] == [True, True, True]


# chooseTeam


def choose(browser, team: str, user: str = "al"):
    response = browser.post("/chooseTeam", data={"user": user, "team": team})
    return response.status_code, body(response)


def test_a_player_chooses_a_team_and_may_leave_it_to_the_referee():
    site = Site(teams=3)
    al = site.browser()
    sign_up(al, "al")
    for team in ("3", "1", "0", "0"):
        assert choose(al, team) == (200, {"status": "OK", "user": "al"})
        assert site.battle.snapshot().players[0].team == int(team)


@pytest.mark.parametrize("team", ["4", "-1", "01", " 1", "١", "x", "1.0", "", "1\n"])
def test_a_team_that_there_is_not_is_refused(team):
    site = Site(teams=3)
    al = site.browser()
    sign_up(al, "al")
    assert choose(al, team) == (400, {"error": "team must be 0 to 3", "status": "ERROR", "user": "al"})
    assert site.battle.snapshot().players[0].team == 0


def test_where_everybody_fights_alone_there_is_no_team(browser):
    sign_up(browser, "al")
    assert choose(browser, "1")[1]["error"] == "there are no teams: everybody fights alone"


def test_an_unknown_user_chooses_nothing(browser):
    assert choose(browser, "1") == (200, {"status": "ERROR", "user": "al"})


def test_who_changes_the_team_all_the_time_is_slowed_down():
    site = Site(teams=2)
    al = site.browser()
    sign_up(al, "al")
    assert 429 in [choose(al, str(number % 2))[0] for number in range(30)]


# updateGameStatus


def test_status_without_players_is_the_two_characters(browser):
    response = browser.post("/updateGameStatus", data={"data": "data"})
    assert response.text == '{"game": 0, "status": "OK", "timeLeft": 0, "users": "[]"}'


def test_status_with_one_player_is_json_within_json(browser):
    sign_up(browser, "al")
    response = browser.post("/updateGameStatus", data={"data": "data"})
    assert response.text == (
        '{"game": 0, "status": "OK", "timeLeft": 0, '
        '"users": "[{\\"ready\\": 0, \\"life\\": 100, \\"name\\": \\"al\\", \\"robot\\": 0}]"}'
    )


def test_status_needs_no_field_and_no_session(browser):
    assert body(browser.post("/updateGameStatus"))["status"] == "OK"


def test_status_counts_down_from_15_in_whole_seconds(site):
    for name in ("al", "bo"):
        browser = site.browser()
        sign_up(browser, name)
        browser.post("/playerReady", data={"user": name, "ready": "1"})
    status = body(site.browser().post("/updateGameStatus"))
    assert (status["game"], status["timeLeft"]) == (1, 15)


# getAvailableRobots, incAlive, session


def test_available_robots(browser):
    everything = '{"availableR": 3, "message": "", "robots": [0, 1, 2], "status": "OK"}'
    assert browser.post("/getAvailableRobots", data={"data": ""}).text == everything
    sign_up(browser, "al")
    free = {"availableR": 2, "message": "", "robots": [1, 2], "status": "OK"}
    assert body(browser.post("/getAvailableRobots")) == free


def test_pings_of_known_and_unknown_robots(browser):
    assert browser.post("/incAlive", data={"ID": "2"}).text == '{"status": "OK"}'
    for unknown in ("3", "-1", "128", "999999999"):
        assert browser.post("/incAlive", data={"ID": unknown}).text == '{"status": "ERROR"}'


def test_a_ping_without_the_robots_key_changes_nothing(site, browser):
    site.battle.add_robot("/keyed", key=key_digest("secret"))
    for fields in ({}, {"key": ""}, {"key": "guess"}, {"key": "x" * 10_000}):
        response = browser.post("/incAlive", data={"ID": "3", **fields})
        assert response.status_code == 403
        assert body(response) == {"error": "only that robot can say that it is alive", "status": "ERROR"}
    assert browser.post("/incAlive", data={"ID": "3", "key": "secret"}).text == '{"status": "OK"}'


def test_a_ping_from_another_address_than_the_robots_changes_nothing(site, browser):
    site.battle.add_robot("/original", address="10.0.0.7")
    here, there = ({"REMOTE_ADDR": address} for address in ("10.0.0.7", "10.0.0.8"))
    assert browser.post("/incAlive", data={"ID": "3"}, environ_base=there).status_code == 403
    assert browser.post("/incAlive", data={"ID": "3"}, environ_base=here).text == '{"status": "OK"}'
    forged = {"X-Forwarded-For": "10.0.0.7"}
    assert browser.post("/incAlive", data={"ID": "3"}, environ_base=there, headers=forged).status_code == 403


def test_a_robot_on_this_machine_may_ping_by_any_of_its_addresses(site, browser):
    site.battle.add_robot("/original", address=machine_of("127.0.0.1"))
    for address in ("127.0.0.1", "::1", "::ffff:127.0.0.1", *own_addresses()):
        ping = browser.post("/incAlive", data={"ID": "3"}, environ_base={"REMOTE_ADDR": address})
        assert ping.text == '{"status": "OK"}', address
    elsewhere = {"REMOTE_ADDR": "203.0.113.7"}
    assert browser.post("/incAlive", data={"ID": "3"}, environ_base=elsewhere).status_code == 403


@pytest.mark.parametrize("robot_id", ["", "x", "1.0", " 1 ", "١", "0x1", "1e3", "+1", "--1", "1\n", "9" * 5000, "None"])
def test_an_id_that_is_no_integer_is_refused(browser, robot_id):
    response = browser.post("/incAlive", data={"ID": robot_id})
    assert response.status_code == 400
    assert body(response) == {"error": "ID must be a whole number", "status": "ERROR"}


def test_session_tells_the_page_who_it_is(site, browser):
    assert browser.get("/session").text == '{"status": "UNREGISTERED"}'
    sign_up(browser, "al")
    answer = body(browser.get("/session"))
    ticket = answer.pop("ticket")
    assert answer == {"robot": 0, "status": "OK", "user": "al"}
    digest, now = site.battle.snapshot().players[0].session, time.time()
    assert [is_session_ticket(ticket, digest, now + later) for later in (0, 58, 61)] == [True, True, False]
    assert not is_session_ticket(ticket, "0" * 64, now)
    assert site.browser().get("/session").text == '{"status": "UNREGISTERED"}'


# every route


@pytest.mark.parametrize(
    ("route", "fields", "missing"),
    [
        ("/signUpUser", {}, "data"),
        ("/signUpUser", {"user": "al"}, "data"),
        ("/signOutUser", {}, "data"),
        ("/playerReady", {}, "user"),
        ("/playerReady", {"user": "al"}, "ready"),
        ("/playerReady", {"ready": "1"}, "user"),
        ("/chooseTeam", {"team": "1"}, "user"),
        ("/chooseTeam", {"user": "al"}, "team"),
        ("/incAlive", {}, "ID"),
        ("/incAlive", {"id": "0"}, "ID"),
    ],
)
def test_a_missing_field_is_named(browser, route, fields, missing):
    response = browser.post(route, data=fields)
    assert response.status_code == 400
    assert body(response) == {"error": f"the form field {missing} is missing", "status": "ERROR"}


@pytest.mark.parametrize(
    "content_type", ["application/json", "text/plain", "multipart/form-data", "", "x/y; charset=utf-99"]
)
@pytest.mark.parametrize("content", [b"\xff\x00\xfe", b'{"data": "al"}', b"data", b""])
def test_a_body_that_is_no_form_is_a_missing_field(browser, content, content_type):
    response = browser.post("/signUpUser", data=content, content_type=content_type)
    assert response.status_code == 400
    assert body(response)["status"] == "ERROR"


def test_broken_utf8_in_a_name_is_a_bad_name(browser):
    response = browser.post("/signUpUser", data=b"data=%ff%fe", content_type="application/x-www-form-urlencoded")
    assert response.status_code == 400


@pytest.mark.parametrize("route", POST_ROUTES)
def test_a_huge_body_is_refused_as_json(site, browser, route):
    response = browser.post(route, data={"data": "x" * 20_000})
    assert response.status_code == 413
    content = body(response)
    assert content["status"] == "ERROR"
    assert content["error"]
    assert players(site) == []


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://localhost:8080", "http://[", ""])
@pytest.mark.parametrize("route", POST_ROUTES)
def test_a_form_on_another_site_is_refused(site, browser, route, origin):
    response = browser.post(route, data={"data": "al", "ID": "0"}, headers={"Origin": origin})
    assert response.status_code == 403
    assert body(response)["status"] == "ERROR"
    assert players(site) == []


# The fields of each route, as an honest client sends them for a player in a seat.
GOOD = {
    "/signUpUser": {"data": "bo", "avatar": "0", "robot": "1", "wait": "1"},
    "/signOutUser": {"data": "al"},
    "/playerReady": {"user": "al", "ready": "1"},
    "/chooseTeam": {"user": "al", "team": "1"},
    "/incAlive": {"ID": "0", "key": "k"},
    "/takeRobot": {},
    "/restarting": {},
    "/updateGameStatus": {},
    "/getAvailableRobots": {},
}
FIELDS = [(route, field) for route, fields in GOOD.items() for field in fields]
REQUIRED = [("/signUpUser", "data"), ("/signOutUser", "data"), ("/playerReady", "user"), ("/playerReady", "ready")]
REQUIRED += [("/chooseTeam", "user"), ("/chooseTeam", "team"), ("/incAlive", "ID")]
NONSENSE = ["", " ", "\x00", "a\r\nSet-Cookie: x=y", "\x1b[2J", "<script>alert(1)</script>", "{}", "[]", "+1", "-"]
NONSENSE += ["1.5", "a  b", "9" * 5000, "\u202e", "\ufffd", "../..", "' OR 1=1 --", "x" * 15_000]


@pytest.fixture
def seated(site):
    """A site on which al has a seat, and al's browser."""
    al = site.browser()
    sign_up(al, "al")
    return site, al


def state(site):
    """All that a request could change, but for the time."""
    snapshot = site.battle.snapshot()
    return snapshot, [robot.alive_at for robot in site.battle._referee._state.robots]


@pytest.mark.parametrize("value", NONSENSE)
@pytest.mark.parametrize(("route", "field"), FIELDS)
def test_nonsense_in_any_field_changes_nothing(seated, route, field, value):
    """Also from who has the right to ask. An answer that is no error says that there is no such thing."""
    site, al = seated
    site.battle.add_robot("/keyed", key=key_digest("k"))
    fields = {**GOOD[route], "ID": "3", field: value} if route == "/incAlive" else {**GOOD[route], field: value}
    before = state(site)
    response = al.post(route, data=fields)
    assert response.status_code in {200, 400, 403}
    content = json.loads(response.text)
    assert "<" not in response.text
    assert content["status"] in {"UNREGISTERED", "ERROR"} if response.status_code == 200 else content["error"]
    assert "Set-Cookie" not in response.headers
    assert state(site) == before


@pytest.mark.parametrize(("route", "field"), REQUIRED)
def test_without_a_required_field_nothing_changes(seated, route, field):
    site, al = seated
    before = state(site)
    response = al.post(route, data={name: value for name, value in GOOD[route].items() if name != field})
    assert response.status_code == 400
    assert body(response) == {"error": f"the form field {field} is missing", "status": "ERROR"}
    assert state(site) == before


@pytest.mark.parametrize("route", POST_ROUTES)
def test_ten_megabytes_and_other_types_change_nothing(seated, route):
    site, al = seated
    before = state(site)
    assert al.post(route, data={"data": "x" * 10_000_000}).status_code == 413
    assert body(al.post(route, data={"data": "x" * 10_000_000}))["status"] == "ERROR"
    if GOOD[route]:
        for kind in ("application/json", "text/plain", "application/octet-stream"):
            assert al.post(route, data=json.dumps(GOOD[route]), content_type=kind).status_code == 400
        assert al.post(route, query_string=GOOD[route]).status_code == 400, "fields in the address are none"
        with_file = {name: (io.BytesIO(value.encode()), "file") for name, value in GOOD[route].items()}
        assert al.post(route, data=with_file, content_type="multipart/form-data").status_code == 400
    assert state(site) == before


@pytest.mark.parametrize("method", ["GET", "PUT", "DELETE", "PATCH", "FOO"])
@pytest.mark.parametrize("route", POST_ROUTES)
def test_other_methods_change_nothing(seated, route, method):
    site, al = seated
    before = state(site)
    response = al.open(route, method=method, query_string=GOOD[route])
    assert response.status_code == 405
    assert "POST" in response.headers["Allow"]
    assert state(site) == before


@pytest.mark.parametrize("cookie", [None, "", "x", "x" * 4000, "another's"])
@pytest.mark.parametrize("route", ["/signOutUser", "/playerReady", "/chooseTeam"])
def test_another_session_changes_nothing(seated, route, cookie):
    site, _ = seated
    eve = site.browser()
    if cookie == "another's":
        sign_up(eve, "eve")
    elif cookie is not None:
        eve.set_cookie("laserbot_session", cookie)
    before = state(site)
    response = eve.post(route, data=GOOD[route])
    assert response.status_code == 403
    assert body(response)["error"]
    assert state(site) == before


def test_at_the_wrong_moment_nothing_changes():
    site = Site(robots=2, countdown=0.1)
    al, bo = site.browser(), site.browser()
    for browser, name in ((al, "al"), (bo, "bo")):
        sign_up(browser, name)
        browser.post("/playerReady", data={"user": name, "ready": "1"})
    site.now += 0.1
    assert site.battle.snapshot().game == 2
    before = state(site)
    assert body(al.post("/playerReady", data={"user": "al", "ready": "0"})) == {"status": "STARTED"}
    assert choose(al, "0") == (200, {"status": "STARTED"})
    assert body(al.post("/takeRobot"))["status"] == "OK", "which al has"
    assert body(site.browser().post("/takeRobot")) == {"status": "UNREGISTERED"}
    assert sign_up(site.browser(), "cy") == {"status": "NO_ROBOTS", "user": "cy"}
    assert sign_up(site.browser(), "al", robot="1") == {"status": "UNAVAILABLE", "user": "al"}
    assert state(site) == before


def test_the_own_page_is_not_another_site(browser):
    response = browser.post("/signUpUser", data={"data": "al"}, headers={"Origin": "http://localhost"})
    assert body(response)["status"] == "OK"


def test_any_request_with_the_session_is_a_sign_of_life():
    now = [100.0]
    battle = GameLoop(Referee(Rules(robot_timeout=1000.0)), clock=lambda: now[0])
    add_linked_robot(battle)
    browser = whole_site(battle, Settings.from_env({})).test_client()
    stranger = whole_site(battle, Settings.from_env({})).test_client()
    browser.post("/signUpUser", data={"data": "al"})
    for _ in range(4):
        now[0] += 40
        browser.post("/updateGameStatus")
    now[0] += 59
    stranger.post("/updateGameStatus")
    assert body(browser.get("/session"))["status"] == "OK"
    now[0] += 60.1
    assert body(browser.get("/session"))["status"] == "UNREGISTERED"


def test_a_name_is_the_same_however_its_letters_are_coded(site, browser):
    assert body(browser.post("/signUpUser", data={"data": "Jo\u0308rg"}))["user"] == "Jörg"
    assert body(site.browser().post("/signUpUser", data={"data": "jörg"}))["status"] == "UNAVAILABLE"


@pytest.fixture
def full():
    """A site whose only robot is ada's, and ada's browser."""
    site = Site(robots=1)
    ada = site.browser()
    assert body(ada.post("/signUpUser", data={"data": "ada"}))["status"] == "OK"
    return site, ada


def test_who_finds_no_robot_waits_is_offered_one_and_takes_it(full):
    site, ada = full
    bob = site.browser()
    assert body(bob.post("/signUpUser", data={"data": "bob"})) == {"status": "NO_ROBOTS", "user": "bob"}
    queued = body(bob.post("/signUpUser", data={"data": "bob", "wait": "1"}))
    assert (queued["status"], queued["place"], queued["offer"]) == ("QUEUED", 1, None)
    assert queued["seconds"] > 0
    assert body(bob.post("/takeRobot")) == {"status": "NO_ROBOTS"}
    assert body(bob.get("/session"))["status"] == "QUEUED"
    ada.post("/signOutUser", data={"data": "ada"})
    offered = body(bob.get("/session"))
    assert (offered["status"], offered["offer"], 0 < offered["seconds"] <= 20) == ("QUEUED", 0, True)
    assert body(bob.post("/takeRobot")) == {"status": "OK", "user": "bob", "robot": 0}
    assert body(bob.get("/session"))["status"] == "OK"


def test_who_waits_can_go(full):
    site, _ = full
    bob = site.browser()
    bob.post("/signUpUser", data={"data": "bob", "wait": "1"})
    assert body(bob.post("/signOutUser", data={"data": "bob"})) == {"status": "OK", "user": "bob"}
    assert body(bob.get("/session")) == {"status": "UNREGISTERED"}


def test_strangers_take_nothing(full):
    site, _ = full
    assert body(site.browser().post("/takeRobot")) == {"status": "UNREGISTERED"}


@pytest.mark.parametrize("wait", ["2", "", "yes", "01", "<b>"])
def test_an_impossible_wait_is_refused(full, wait):
    site, _ = full
    response = site.browser().post("/signUpUser", data={"data": "bob", "wait": wait})
    assert response.status_code == 400
    assert body(response) == {"error": "wait must be 0 or 1", "status": "ERROR", "user": "bob"}
    assert site.battle.snapshot().queue == ()


def test_a_visitors_address_is_not_kept(site):
    site.browser().post("/signUpUser", data={"data": "al"}, environ_base={"REMOTE_ADDR": "10.1.2.3"})
    (signed_up,) = [one.event for one in site.battle._referee.take_journal() if "al signed up" in str(one.event)]
    assert signed_up.address
    assert "10.1.2.3" not in str(events.to_json(signed_up))


def test_who_changes_his_mind_too_often_waits(site):
    browser = site.browser()
    sign_up(browser, "al")
    answers = [browser.post("/playerReady", data={"user": "al", "ready": str(number % 2)}) for number in range(21)]
    assert [answer.status_code for answer in answers] == [200] * 20 + [429]
    assert answers[-1].headers["Retry-After"] == "1"
