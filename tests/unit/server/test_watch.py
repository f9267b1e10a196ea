"""The screen for spectators: the address that players reach, and what everybody may know."""

import json
import re

import pytest
import segno

from laser_bot_battle.interfaces import LanAddress
from laser_bot_battle.msg import GameStatus, UserStatus
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.robot_health import RobotsHealth
from server.game.rules import Rules
from server.pages import watch
from server.pages.watch import players_address
from server.ros.status import to_message
from server.web.settings import Settings
from server.web.watch import create_watch, public_status
from tests.support.site import whole_site

LAN = [LanAddress("192.168.7.4", 24), LanAddress("10.0.0.9", 8)]


@pytest.fixture
def browser():
    game, settings = GameLoop(Referee(Rules())), Settings.from_env({})
    return whole_site(game, settings, create_watch(game, RobotsHealth())).test_client()


@pytest.fixture
def lan(monkeypatch):
    """This machine is in a network."""
    monkeypatch.setattr(watch, "reachable_addresses", lambda bind: LAN if bind == "0.0.0.0" else [])


def test_the_page_needs_no_session_and_gives_none(browser):
    response = browser.get("/watch")
    assert response.status_code == 200
    assert "Set-Cookie" not in response.headers
    assert re.search(r'<meta name="utc-offset" content="-?\d+">', response.text)


ELSEWHERE = ["battle.local:5000", "192.168.7.4:5000", "laser-bot-master.local", "[fd00::7]:5000", "a.example:80"]
LOOPBACK = ["localhost:5000", "127.0.0.1:5000", "127.1.2.3", "[::1]:5000", "0.0.0.0:5000", "LOCALHOST", "a.localhost"]


@pytest.mark.parametrize("host", ELSEWHERE)
@pytest.mark.usefixtures("lan")
def test_players_reach_the_game_as_the_spectator_does(host):
    assert players_address("http", host, "0.0.0.0", 5000) == f"http://{host}"
    assert players_address("https", host, "0.0.0.0", 5000) == f"https://{host}"


@pytest.mark.parametrize("host", LOOPBACK)
@pytest.mark.usefixtures("lan")
def test_a_screen_on_the_master_shows_its_address_in_the_network(host):
    assert players_address("http", host, "0.0.0.0", 5000) == "http://192.168.7.4:5000"


@pytest.mark.usefixtures("lan")
def test_a_server_that_only_this_machine_reaches_says_so():
    assert players_address("http", "localhost:5000", "127.0.0.1", 5000) == "http://localhost:5000"


def test_the_code_leads_to_the_address_that_is_shown(browser):
    page = browser.get("/watch", headers={"Host": "battle.local:5000"}).text
    assert page.count("battle.local:5000") >= 2  # for eyes and for screen readers
    (code,) = re.findall(r'<div class="watch-code".*?</div>', page, re.DOTALL)
    wanted = segno.make("http://battle.local:5000", micro=False, error="m").svg_inline(border=4)
    assert re.findall(r' d="[^"]+"', wanted)[-1] in code
    assert 'stroke="#000"' in code
    assert 'fill="#fff"' in code


@pytest.mark.parametrize(("language", "word"), [("en", "Join in!"), ("it", "Gioca anche tu!"), ("de", "Spiel mit!")])
def test_the_page_is_in_the_visitors_language(browser, language, word):
    page = browser.get("/watch", headers={"Accept-Language": language}).text
    assert f'<html lang="{language}"' in page
    assert word in page


def test_the_state_has_the_fields_of_game_status_and_no_secret(match):
    match.start("Al", "Bo")
    match.referee.sign_up("Cy", match.session("Cy"), 2, match.now)
    match.hit("Bo", 2)
    state = public_status(match.state)
    assert set(state) == set(GameStatus.__slots__)
    assert all(set(user) == set(UserStatus.__slots__) - {"session"} for user in state["users"])
    assert {user["name"]: user["life"] for user in state["users"]} == {"Al": 100, "Bo": 80, "Cy": 100}
    assert "session" not in json.dumps(state)
    match.hit("Bo", 8)
    result = public_status(match.state)["result"]
    assert [(entry["name"], entry["place"]) for entry in result] == [("Al", 1), ("Bo", 2)]
    assert all(set(entry) == set(UserStatus.__slots__) - {"session"} for entry in result)


def test_how_long_nobody_can_be_hit_is_told_everywhere(new_match):
    match = new_match(protection=3)
    match.start("Al", "Bo")
    match.wait(0.5)
    assert public_status(match.state)["protection"] == pytest.approx(2.5)
    assert to_message(match.state).protection == pytest.approx(2.5)


def test_the_queue_is_told_by_names(new_match):
    match = new_match(robots=1)
    match.sign_up("Al")
    for name in ("Bo", "Cy"):
        match.referee.sign_up(name, match.session(name), 0, match.now, wait=True)
    assert public_status(match.state)["queue"] == ["Bo", "Cy"]


def test_the_state_is_json_for_everybody(browser):
    response = browser.get("/watch.json")
    assert response.content_type == "application/json; charset=utf-8"
    assert response.headers["Cache-Control"] == "no-store"
    assert response.json["game"] == 0
    assert browser.post("/watch.json").status_code == 405
