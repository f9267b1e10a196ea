"""Arenas that share a domain: a player has one session and one name in all of them, and signs out of one at a time."""

import secrets

import pytest

from laser_bot_battle.settings import SettingsError
from server.access.sharing import ALONE, Sharing, is_token, sharing
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.site import whole_site

TOKEN = secrets.token_urlsafe(32)
OTHER = "b" * 43


class Arena:
    """At http://`name`.example, with three robots and visitors who come with a cookie."""

    def __init__(self, name: str, domain: str = "arena.example", scheme: str = "http") -> None:
        self.base = f"http://{name}.arena.example"
        self.scheme = scheme  # as the proxy before it says
        self.battle = GameLoop(Referee(Rules()), clock=lambda: 1000.0)
        for _ in range(3):
            add_linked_robot(self.battle)
        self.app = whole_site(self.battle, Settings.from_env({"LASERBOT_DOMAIN": domain}))

    def post(self, route, token="", **fields):
        browser = self.app.test_client(use_cookies=False)
        headers = {"X-Forwarded-Proto": self.scheme}
        headers |= {"Cookie": f"laserbot_session={token}"} if token else {}
        return browser.post(route, base_url=self.base, headers=headers, data=fields)

    @property
    def players(self):
        return [player.name for player in self.battle.snapshot().players]


def cookies(response):
    """By name, the last of each: value and attributes."""
    found = {}
    for line in response.headers.getlist("Set-Cookie"):
        pair, *attributes = line.split("; ")
        name, _, value = pair.partition("=")
        found[name] = value, set(attributes)
    return found


@pytest.mark.parametrize(
    ("domain", "host", "found"),
    [
        ("", "red.arena.example", ALONE),
        ("arena.example", "red.arena.example", Sharing(True, "arena.example")),
        ("arena.example", "RED.Arena.Example:8443", Sharing(True, "arena.example")),
        ("arena.example", "arena.example", Sharing(True, "arena.example")),
        ("arena.example", "notarena.example", ALONE),
        ("arena.example", "arena.example.evil.example", ALONE),
        ("arena.example", "10.0.0.7:30510", ALONE),
        ("*", "10.0.0.7:30510", Sharing(True, None)),
        ("*", "[fd00::1]:30510", Sharing(True, None)),
        ("10.0.0.7", "10.0.0.7:30510", Sharing(True, None)),
        ("localhost", "localhost:30510", Sharing(True, None)),
        ("*", "", ALONE),
        ("*", "[::1", ALONE),
    ],
)
def test_what_the_cookies_are_for(domain, host, found):
    assert sharing(domain, host) == found


@pytest.mark.parametrize("text", ["", "guess", "a" * 42, "a" * 44, "ä" * 43, f"{'a' * 42};"])
def test_what_could_be_guessed_is_no_session(text):
    assert not is_token(text)
    assert is_token(TOKEN)


@pytest.mark.parametrize(
    "text", ["http://arena.example", "arena.example:80", ".arena.example", "a b", "*.arena.example"]
)
def test_a_domain_is_only_a_domain(text):
    with pytest.raises(SettingsError, match="LASERBOT_DOMAIN"):
        Settings.from_env({"LASERBOT_DOMAIN": text})


def test_the_first_arena_gives_a_session_for_the_whole_domain():
    token, attributes = cookies(Arena("red").post("/signUpUser", data="Ann"))["laserbot_session"]
    assert is_token(token)
    assert {"Domain=arena.example", "HttpOnly", "SameSite=Lax", "Path=/"} <= attributes


def test_the_next_arena_keeps_the_session_and_learns_the_name():
    red, blue = Arena("red"), Arena("blue")
    first = cookies(red.post("/signUpUser", data="Jörg Lee", avatar=3))
    token = first["laserbot_session"][0]
    name, attributes = first["laserbot_name"]
    assert name == "3.J%C3%B6rg%20Lee"
    assert "Domain=arena.example" in attributes
    assert "HttpOnly" not in attributes  # the login page reads it
    assert cookies(blue.post("/signUpUser", token, data="Jörg Lee"))["laserbot_session"][0] == token


def test_one_session_is_a_player_in_each_arena():
    red, blue = Arena("red"), Arena("blue")
    for arena in (red, blue):
        arena.post("/signUpUser", TOKEN, data="Ann")
        assert '"status": "OK"' in arena.post("/playerReady", TOKEN, user="Ann", ready=1).text


def test_another_name_in_the_same_arena_takes_the_place_of_the_first():
    arena = Arena("red")
    arena.post("/signUpUser", TOKEN, data="Ann")
    answer = arena.post("/signUpUser", TOKEN, data="Bo")
    assert arena.players == ["Bo"]
    assert cookies(answer)["laserbot_session"][0] == TOKEN
    assert '"status": "OK"' in arena.post("/playerReady", TOKEN, user="Bo", ready=1).text


def test_a_token_that_could_be_guessed_is_not_taken_over():
    assert is_token(cookies(Arena("red").post("/signUpUser", "guess", data="Ann"))["laserbot_session"][0])


def test_whoever_signs_out_of_one_arena_is_still_in_the_other():
    arena = Arena("red")
    arena.post("/signUpUser", TOKEN, data="Ann")
    answer = arena.post("/signOutUser", TOKEN, data="Ann")
    assert arena.players == []
    assert "laserbot_session" not in cookies(answer)
    name, attributes = cookies(answer)["laserbot_name"]
    assert name == ""
    assert {"Max-Age=0", "Domain=arena.example", "Path=/"} <= attributes


def test_a_name_is_remembered_though_somebody_else_has_tried_to_sign_it_out():
    arena = Arena("red")
    arena.post("/signUpUser", TOKEN, data="Ann")
    assert cookies(arena.post("/signOutUser", data="Ann")) == {}


def test_an_arena_by_https_takes_no_cookie_from_one_by_http():
    """A browser lets no page by http replace a cookie that has Secure, nor read it."""
    by_https = cookies(Arena("red", scheme="https").post("/signUpUser", data="Ann"))
    by_http = cookies(Arena("blue").post("/signUpUser", data="Ann"))
    secure = {name for name, (_, attributes) in by_https.items() if "Secure" in attributes}
    assert secure == {"__Secure-laserbot_session"}
    assert by_http.keys() == {"laserbot_session", "laserbot_name"}


def test_by_https_the_session_of_an_arena_by_http_holds_until_there_is_a_secure_one():
    arena = Arena("red", scheme="https")
    answer = cookies(arena.post("/signUpUser", TOKEN, data="Ann"))
    assert answer["__Secure-laserbot_session"][0] == TOKEN
    assert '"status": "OK"' in arena.post("/playerReady", TOKEN, user="Ann", ready=1).text
    both = f"{OTHER}; __Secure-laserbot_session={TOKEN}"
    assert '"status": "OK"' in arena.post("/playerReady", both, user="Ann", ready=0).text


def test_a_cookie_of_this_host_alone_does_not_hide_the_domains():
    answer = Arena("red").post("/signUpUser", data="Ann")
    sent = [line for line in answer.headers.getlist("Set-Cookie") if line.startswith("laserbot_session=")]
    assert ["Domain=" in line for line in sent] == [False, True]
    assert "Max-Age=0" in sent[0]


@pytest.mark.parametrize("domain", ["", "other.example"])
def test_an_arena_on_its_own_makes_a_new_session_each_time(domain):
    answer = cookies(Arena("red", domain).post("/signUpUser", TOKEN, data="Ann"))
    token, attributes = answer["laserbot_session"]
    assert token != TOKEN
    assert not any(attribute.startswith("Domain") for attribute in attributes)
    assert "laserbot_name" not in answer


def test_the_login_page_knows_whose_cookies_it_may_take_away():
    page = Arena("red").app.test_client().get("/", base_url="http://red.arena.example").text
    assert '<meta name="domain" content="arena.example">' in page
