"""What browsers get besides pages: names with a hash, kept for good, compressed; and where pages may connect to."""

import gzip

import pytest

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.assets import asset
from server.web.settings import Settings
from tests.support.site import whole_site


def browser_of(**variables: str):
    return whole_site(GameLoop(Referee(Rules())), Settings.from_env(variables)).test_client()


@pytest.fixture(scope="module")
def browser():
    return browser_of()


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("css/common.css", "text/css"),
        ("js/common/text_page.js", "text/javascript"),
        ("img/logo.svg", "image/svg+xml"),
        ("img/favicon.png", "image/png"),
        ("type/oxanium-latin-wght-normal.woff2", "font/woff2"),
    ],
)
def test_a_file_with_a_hash_in_its_name_is_kept_for_good(browser, name, kind):
    response = browser.get(asset(name), buffered=True)
    assert response.status_code == 200
    assert response.content_type.partition(";")[0] == kind
    assert {"max-age=315360000", "public", "immutable"} <= set(response.headers["Cache-Control"].split(", "))
    assert response.headers["X-Content-Type-Options"] == "nosniff"
    assert "Access-Control-Allow-Origin" not in response.headers


def test_each_browser_gets_the_smallest_file_that_it_can_read(browser):
    address = asset("css/common.css")
    plain = browser.get(address, buffered=True)
    assert "Content-Encoding" not in plain.headers
    sizes = {}
    for accept, encoding in (("gzip, deflate, br, zstd", "br"), ("gzip", "gzip"), ("identity", None)):
        response = browser.get(address, headers={"Accept-Encoding": accept}, buffered=True)
        assert response.headers.get("Content-Encoding") == encoding
        assert "Accept-Encoding" in response.headers["Vary"]
        sizes[encoding] = len(response.data)
        if encoding == "gzip":
            assert gzip.decompress(response.data) == plain.data
    assert sizes["br"] < sizes["gzip"] < sizes[None]


def test_pages_are_compressed_for_browsers_that_can_read_that(browser):
    plain = browser.get("/home")
    small = browser.get("/home", headers={"Accept-Encoding": "gzip, deflate, br"})
    assert "Content-Encoding" not in plain.headers
    assert small.headers["Content-Encoding"] == "gzip"
    assert small.headers["Vary"] == plain.headers["Vary"] == "Accept-Encoding"
    assert gzip.decompress(small.data) == plain.data
    assert len(small.data) == int(small.headers["Content-Length"]) < len(plain.data) / 2
    refused = browser.get("/home", headers={"Accept-Encoding": "gzip;q=0"})
    assert refused.data == plain.data


def test_answers_to_pages_and_robots_stay_plain(browser):
    answer = browser.post("/updateGameStatus", headers={"Accept-Encoding": "gzip"})
    assert "Content-Encoding" not in answer.headers


def test_every_file_that_a_page_names_is_there(browser):
    for path in ("/", "/home", "/about", "/results", "/operator", "/nothing"):
        for part in browser.get(path).text.split('"'):
            if part.startswith("/static/"):
                assert browser.head(part, buffered=True).status_code == 200, part


@pytest.mark.parametrize(
    "path",
    [
        "/static/",
        "/static/nothing.js",
        "/static/common.css",
        "/static/css/common.css",
        "/static/common-00000000.css",
        "/static/manifest.json.gz",
        "/static/../main.py",
        "/static/%2e%2e/main.py",
        "/static/..%2fwords/en.json",
        "/static/img/../../words/en.json",
        "/static//etc/passwd",
        "/static/%00",
    ],
)
def test_anything_else_is_not_found(browser, path):
    response = browser.get(path)
    assert response.status_code == 404
    assert "Error 404" in response.text
    assert response.headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize(
    ("host", "name"),
    [
        ("localhost", "localhost"),
        ("laser-bot-master.local:5000", "laser-bot-master.local"),
        ("192.168.1.5:5000", "192.168.1.5"),
        # browsers ignore these in a policy
        ("laser_bot_master.local:5000", "*"),
        ("[::1]:5000", "*"),
        ("[::1]", "*"),
    ],
)
def test_a_page_may_connect_to_its_own_host_only(host, name):
    browser = browser_of(LASERBOT_ROSBRIDGE_PORT="9123", LASERBOT_RELAY_PORT="9124")
    policy = policy_of(browser.get("/home", headers={"Host": host}))
    sockets = [f"{scheme}://{name}:{port}" for port in (9123, 9124) for scheme in ("ws", "wss")]
    assert policy["connect-src"] == ["'self'", *sockets]
    assert policy["frame-src"] == ["'none'"]
    assert policy["default-src"] == ["'self'"]
    assert "'unsafe-inline'" not in policy.get("script-src", [])


def test_behind_the_front_everything_is_at_the_pages_own_address() -> None:
    browser = browser_of()
    policy = policy_of(browser.get("/home", headers={"Host": "arena.local:8080", "X-Laserbot-Front": "yes"}))
    assert policy["connect-src"] == ["'self'", "ws://arena.local:8080", "wss://arena.local:8080"]


def policy_of(response) -> dict[str, list[str]]:
    """By directive."""
    parts = (part.split() for part in response.headers["Content-Security-Policy"].split(";"))
    return {directive: sources for directive, *sources in parts}
