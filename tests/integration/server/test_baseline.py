"""What a scanner of web sites looks at first, on every address of the real server that can be got without arguments."""

import re

import pytest
import requests

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.settings import Settings
from server.web.app import create_app
from tests.integration.server.conftest import GameServer

APP = create_app(GameLoop(Referee(Rules())), Settings.from_env({}))
PATHS = {rule.rule for rule in APP.url_map.iter_rules() if "GET" in (rule.methods or ()) and not rule.arguments}
PATHS |= {"/watch", "/operator", "/nothing", "/../../etc/passwd", "/%00"}
VERSION = re.compile(r"[0-9]+\.[0-9]+")


def test_every_page_has_the_headers_of_a_careful_server_and_none_that_tells_versions(server: GameServer) -> None:
    assert len(PATHS) > 10
    for path in sorted(PATHS):
        answer = requests.get(server.url + path, timeout=20, allow_redirects=False)
        headers = answer.headers
        assert answer.status_code < 500, path
        assert headers["X-Content-Type-Options"] == "nosniff", path
        assert headers["Referrer-Policy"] == "same-origin", path
        assert "frame-ancestors" in headers["Content-Security-Policy"], path
        assert "default-src" in headers["Content-Security-Policy"], path
        assert not VERSION.search(headers.get("Server", "") + headers.get("X-Powered-By", "")), path
        assert "Access-Control-Allow-Origin" not in headers, path
        assert "Traceback" not in answer.text, path


def test_a_session_is_out_of_reach_of_scripts_and_of_other_sites(server: GameServer) -> None:
    cookie = requests.post(f"{server.url}/signUpUser", data={"data": "Ann"}, timeout=20).headers.get("Set-Cookie", "")
    if cookie:  # without a robot there is a place in the queue, and its cookie
        assert {"HttpOnly", "SameSite=Lax", "Path=/"} <= {word.strip() for word in cookie.split(";")}


@pytest.mark.parametrize("method", ["TRACE", "TRACK", "CONNECT", "PUT", "DELETE", "PATCH", "x"])
def test_methods_that_nothing_needs_are_refused(server: GameServer, method: str) -> None:
    answer = requests.request(method, f"{server.url}/", headers={"X-Secret": "abc"}, timeout=20)
    assert answer.status_code in {400, 405, 501}
    assert "abc" not in answer.text
