"""Pages, error pages and headers."""

import logging
import re

import pytest

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.site import whole_site


@pytest.fixture
def app():
    return whole_site(GameLoop(Referee(Rules())), Settings.from_env({"LASERBOT_ROSBRIDGE_PORT": "9123"}))


@pytest.fixture
def browser(app):
    return app.test_client()


@pytest.mark.parametrize("path", ["/", "/home", "/about"])
def test_pages_are_html_and_never_cached(browser, path):
    response = browser.get(path)
    assert response.status_code == 200
    assert response.content_type == "text/html; charset=utf-8"
    assert response.text.lstrip().lower().startswith("<!doctype html>")
    assert response.headers["Cache-Control"] == "no-store"
    assert browser.head(path).status_code == 200


def test_home_tells_where_rosbridge_is(browser):
    assert '<meta name="rosbridge-port" content="9123">' in browser.get("/home").text


@pytest.mark.parametrize("path", ["/", "/home", "/watch"])
def test_pages_with_the_arena_have_its_place(browser, path):
    assert re.search(
        r'<section id="arena" class="arena" aria-label="[^"]+" hidden><canvas role="img" aria-label="\w',
        browser.get(path).text,
    )


@pytest.mark.parametrize("method", ["get", "post"])
@pytest.mark.parametrize("path", ["/nothing", "/home/", "/streaming", "/signupuser", "/../main.py"])
def test_an_unknown_address_gets_the_404_page(browser, path, method):
    response = getattr(browser, method)(path)
    assert response.status_code == 404
    assert "Error 404" in response.text


@pytest.mark.parametrize("path", ["/static/nothing.js", "/static/../main.py", "/static/%2e%2e/main.py"])
def test_static_files_are_only_those_of_the_static_folder(browser, path):
    assert browser.get(path).status_code == 404


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("get", "/signUpUser", {"POST", "OPTIONS"}),
        ("put", "/incAlive", {"POST", "OPTIONS"}),
        ("delete", "/updateGameStatus", {"POST", "OPTIONS"}),
        ("post", "/", {"GET", "HEAD", "OPTIONS"}),
        ("post", "/home", {"GET", "HEAD", "OPTIONS"}),
    ],
)
def test_a_wrong_method_gets_the_405_page_that_names_the_allowed_ones(browser, method, path, allowed):
    response = getattr(browser, method)(path)
    assert response.status_code == 405
    assert "Error 405" in response.text
    assert set(response.headers["Allow"].split(", ")) == allowed


def test_options_names_the_methods(browser):
    response = browser.options("/signUpUser")
    assert response.status_code == 200
    assert set(response.headers["Allow"].split(", ")) == {"POST", "OPTIONS"}


def test_an_exception_gets_the_500_page_and_a_log_entry_but_no_traceback_page(app, caplog):
    def fail():
        raise RuntimeError("secret detail")

    app.add_url_rule("/fail", view_func=fail)
    with caplog.at_level(logging.ERROR):
        response = app.test_client().get("/fail")
    assert response.status_code == 500
    assert "Error 500" in response.text
    assert "secret detail" not in response.text
    assert "secret detail" in caplog.text


@pytest.mark.parametrize("path", ["/", "/home", "/nothing", "/session"])
def test_security_headers(browser, path):
    headers = browser.get(path).headers
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "same-origin"
    assert "frame-ancestors" in headers["Content-Security-Policy"]


def test_pages_may_open_a_websocket_to_rosbridge(browser):
    policy = browser.get("/home").headers["Content-Security-Policy"]
    assert "connect-src 'self' ws:" in policy


def test_a_huge_body_to_a_page_is_refused(browser):
    assert browser.post("/home", data=b"x" * 20_000).status_code in {405, 413}


@pytest.mark.parametrize(
    "host", ["localhost", "10.0.0.7:5000", "laser_bot_master.local:5000", "laser-bot-master.local", "[::1]:5000"]
)
def test_a_form_of_our_own_page_is_taken_under_each_of_its_names(browser, host):
    def sign_out(origin):
        headers = {"Host": host, "Origin": origin}
        return browser.post("/signOutUser", data={"data": "nobody"}, headers=headers)

    assert "UNREGISTERED" in sign_out(f"http://{host}").text
    assert sign_out("http://evil.example").status_code == 403
