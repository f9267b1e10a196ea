"""Forms, pages and cookies behind a proxy: its word counts if it is believed, and LASERBOT_ORIGINS always."""

from typing import Any

import pytest
from flask.testing import FlaskClient
from werkzeug.test import TestResponse

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.site import whole_site

MASTER = "127.0.0.1:5000"  # what a proxy takes for Host, unless it is told otherwise
HERE, ELSEWHERE = {"REMOTE_ADDR": "127.0.0.1"}, {"REMOTE_ADDR": "10.0.0.9"}


def browser_of(**variables: str) -> FlaskClient:
    game = GameLoop(Referee(Rules()), clock=lambda: 1000.0)  # in which no robot falls silent
    for _ in range(3):
        add_linked_robot(game)
    return whole_site(game, Settings.from_env(variables)).test_client()


def sign_up(browser: FlaskClient, origin: str, peer: dict[str, str] = HERE, /, **told: str) -> TestResponse:
    """By a page of `origin`; `told` are further headers, with _ for -."""
    headers = {"Host": MASTER, "Origin": origin, **{name.replace("_", "-"): value for name, value in told.items()}}
    return browser.post("/signUpUser", data={"data": "al"}, headers=headers, environ_base=peer)


@pytest.mark.parametrize(
    ("variables", "origin", "told"),
    [
        ({}, "http://127.0.0.1:5000", {}),
        ({}, "http://arena.example", {"Host": "arena.example"}),
        ({}, "http://ARENA.example", {"X_Forwarded_Host": "arena.example"}),
        ({}, "http://arena.example:8000", {"X_Forwarded_Host": "arena.example:8000"}),
        ({}, "http://arena.example", {"X_Forwarded_Host": "forged.example, arena.example"}),
        ({}, "https://arena.example", {"X_Forwarded_Host": "arena.example", "X_Forwarded_Proto": "https"}),
        ({}, "https://arena.example", {"X_Forwarded_Host": "arena.example:443", "X_Forwarded_Proto": "https"}),
        # TLS has ended at another proxy, before the one that says this
        ({}, "https://arena.example", {"X_Forwarded_Host": "arena.example", "X_Forwarded_Proto": "http"}),
        ({}, "https://arena.example", {"Host": "arena.example", "X_Forwarded_Proto": "https"}),
        ({"LASERBOT_ORIGINS": "http://arena.example"}, "http://arena.example", {}),
        ({"LASERBOT_ORIGINS": "http://a.example https://Arena.example:8443"}, "https://arena.example:8443", {}),
    ],
)
def test_a_form_of_the_page_that_the_visitor_sees_is_taken(
    variables: dict[str, str], origin: str, told: dict[str, str]
) -> None:
    assert '"status": "OK"' in sign_up(browser_of(**variables), origin, **told).text


@pytest.mark.parametrize(
    ("variables", "origin", "peer", "told"),
    [
        ({}, "http://arena.example", HERE, {}),
        ({}, "http://evil.example", HERE, {"X_Forwarded_Host": "arena.example"}),
        ({}, "http://forged.example", HERE, {"X_Forwarded_Host": "forged.example, arena.example"}),
        ({}, "http://arena.example:81", HERE, {"X_Forwarded_Host": "arena.example"}),
        ({}, "http://arena.example", HERE, {"X_Forwarded_Host": "arena.example", "X_Forwarded_Proto": "https"}),
        ({}, "http://arena.example", HERE, {"X_Forwarded_Host": "arena.example/"}),
        ({}, "http://arena.example", ELSEWHERE, {"X_Forwarded_Host": "arena.example"}),
        ({"LASERBOT_PROXIES": "10.0.1.0/24"}, "http://arena.example", ELSEWHERE, {"X_Forwarded_Host": "arena.example"}),
        ({"LASERBOT_ORIGINS": "https://arena.example"}, "http://arena.example", HERE, {}),
        ({"LASERBOT_ORIGINS": "https://arena.example"}, "https://evil.example", HERE, {}),
        # its own page has its own port
        ({}, "http://127.0.0.1:5000", HERE, {"Host": "127.0.0.1:8000"}),
    ],
)
def test_a_form_of_any_other_page_is_refused_and_told_what_to_do(
    variables: dict[str, str], origin: str, peer: dict[str, str], told: dict[str, str]
) -> None:
    answer = sign_up(browser_of(**variables), origin, peer, **told)
    assert answer.status_code == 403
    assert origin in answer.text
    assert "LASERBOT_ORIGINS" in answer.text
    assert "Set-Cookie" not in answer.headers


def test_a_proxy_elsewhere_is_believed_if_it_is_named() -> None:
    browser = browser_of(LASERBOT_PROXIES="10.0.0.0/24")
    assert sign_up(browser, "http://arena.example", ELSEWHERE, X_Forwarded_Host="arena.example").status_code == 200


@pytest.mark.parametrize(
    ("variables", "origin", "peer", "told", "secure"),
    [
        ({}, "http://127.0.0.1:5000", HERE, {}, False),
        ({}, "https://127.0.0.1:5000", HERE, {"X_Forwarded_Proto": "https"}, True),
        ({}, "http://127.0.0.1:5000", ELSEWHERE, {"X_Forwarded_Proto": "https"}, False),
        ({"LASERBOT_ORIGINS": "https://arena.example"}, "https://arena.example", HERE, {}, True),
        ({"LASERBOT_ORIGINS": "http://arena.example"}, "http://arena.example", HERE, {}, False),
    ],
)
def test_the_cookie_of_a_page_by_tls_goes_back_by_tls_only(
    variables: dict[str, str], origin: str, peer: dict[str, str], told: dict[str, str], secure: bool
) -> None:
    cookie = sign_up(browser_of(**variables), origin, peer, **told).headers["Set-Cookie"]
    assert ("Secure" in cookie.split("; ")) == secure


def policy(browser: FlaskClient, peer: dict[str, str] = HERE, /, **told: str) -> str:
    """What the page may connect to."""
    headers = {"Host": MASTER, **{name.replace("_", "-"): value for name, value in told.items()}}
    whole = browser.get("/home", headers=headers, environ_base=peer).headers["Content-Security-Policy"]
    return whole.partition("connect-src 'self' ")[2].partition(";")[0]


def test_a_page_finds_its_programs_where_the_visitor_is() -> None:
    name, front = {"X_Forwarded_Host": "arena.example:81"}, {"X_Laserbot_Front": "yes"}
    at_ports = "ws://arena.example:9090 wss://arena.example:9090 ws://arena.example:9091 wss://arena.example:9091"
    assert policy(browser_of(), **name) == at_ports
    assert policy(browser_of(), **name, **front) == "ws://arena.example:81 wss://arena.example:81"
    assert "arena.example" not in policy(browser_of(), ELSEWHERE, **name)


def test_a_page_may_be_at_each_address_that_the_operator_names() -> None:
    browser = browser_of(LASERBOT_ORIGINS="https://arena.example http://127.0.0.1:5000")
    here = "ws://127.0.0.1:9090 wss://127.0.0.1:9090 ws://127.0.0.1:9091 wss://127.0.0.1:9091"
    assert policy(browser) == f"{here} {here.replace('127.0.0.1', 'arena.example')}"
    front = policy(browser, X_Laserbot_Front="yes")
    assert front == "ws://127.0.0.1:5000 wss://127.0.0.1:5000 ws://arena.example wss://arena.example"


@pytest.mark.parametrize(
    ("peer", "told", "address"),
    [
        (HERE, {"X-Forwarded-Host": "arena.example", "X-Forwarded-Proto": "https"}, "https://arena.example"),
        (HERE, {"X-Forwarded-Host": "arena.example:443", "X-Forwarded-Proto": "https"}, "https://arena.example"),
        (HERE, {"X-Forwarded-Host": "arena.example:8080"}, "http://arena.example:8080"),
        (ELSEWHERE, {"X-Forwarded-Host": "arena.example", "X-Forwarded-Proto": "https"}, "http://master.local:5000"),
    ],
)
def test_the_screen_shows_the_address_that_visitors_see(
    peer: dict[str, str], told: dict[str, Any], address: str
) -> None:
    page = browser_of().get("/watch", headers={"Host": "master.local:5000", **told}, environ_base=peer).text
    assert address in page
