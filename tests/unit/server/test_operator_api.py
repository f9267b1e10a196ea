"""The operators' API over the web application: what they see and decide, and that nobody else does."""

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jinja2 import DictLoader
from sqlalchemy import URL

from laser_bot_battle.names import is_operator_ticket
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.robot_health import RobotsHealth
from server.game.rules import DECLARED, Rules
from server.store.database import Database
from server.store.log import EventLog
from server.web.bots import BotsProgram, create_bots
from server.web.one_address import MANY
from server.web.operator import create_operator
from server.web.operator_access import MAX_SESSIONS, SESSION_LIFE, Access
from server.web.operator_api import create_operator_api
from server.web.settings import Settings
from tests.support.journals import KERNEL, from_container, write_journal
from tests.support.linked import add_linked_robot
from tests.support.polling import until
from tests.support.site import whole_site

TOKEN = "the operators' token"
TWO = [{"name": name, "own": False} for name in ("children", "beginners")]  # to vote on
BEARER = {"Authorization": f"Bearer {TOKEN}"}
HUGE = "x" * 10_000_000
# stand-ins: the real pages are tried in tests/browser
PAGES = {
    "operator.html": "desk of {{ operator }}",
    "operator_login.html": "sign in: {{ code }}",
    "operator_off.html": "no token",
}


class Site:
    """The application over a real game with robots 0 to 2, a real database, and a clock that the test moves."""

    def __init__(self, folder: Path, token: str = TOKEN, **variables: str) -> None:
        self.now = 1000.0
        self.referee = Referee(Rules(protection=0))
        self.game = GameLoop(self.referee, clock=lambda: self.now)
        for number in range(3):
            add_linked_robot(self.game, f"/id_service_client_pi{number}")
        self.database = Database(URL.create("sqlite", database=str(folder / "game.db")))
        self.database.open()
        self.log = EventLog(self.database)
        self.health = RobotsHealth(clock=lambda: self.now)
        self.bots = BotsProgram(clock=lambda: self.now)
        self.overhead: list[str] = []  # the troubles of the camera above the floor
        self.deaf: set[int] = set()  # robots where nobody listens to what they are asked
        self.identified: list[int] = []
        self.asked: list[bytes] = []  # what was passed on to who counts votes
        variables = {
            "LASERBOT_OPERATOR_TOKEN": token,
            "LASERBOT_ROSBRIDGE_PORT": "9191",
            "LASERBOT_RELAY_PORT": "9192",
            **variables,
        }
        settings = Settings.from_env(variables)
        access = Access(settings.operator_token, clock=lambda: self.now)
        api = create_operator_api(
            self.game,
            settings,
            access,
            self.database,
            self.log,
            health=self.health,
            bots=self.bots,
            overhead=lambda: self.overhead,
            identify=self.identify,
            ask_audience=self.asked.append,
        )
        self.app = whole_site(
            self.game, Settings.from_env({}), create_operator(access), api, create_bots(self.game, self.bots)
        )
        self.app.jinja_loader = DictLoader(PAGES)

    def identify(self, robot_id: int) -> bool:
        self.identified += [] if robot_id in self.deaf else [robot_id]
        return robot_id not in self.deaf

    def browser(self) -> Any:
        return self.app.test_client()

    def operator(self, name: str = "Ann") -> Any:
        """A browser that has signed in."""
        browser = self.browser()
        assert browser.post("/operator/login", json={"token": TOKEN, "name": name}).status_code == 204
        return browser

    def players(self, *names: str, ready: bool = False) -> None:
        for name in names:
            self.game.sign_up(name, f"session of {name}", 0, wait=True)
            if ready:
                self.game.set_ready(name, True, f"session of {name}")

    def pass_time(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self.now = min(self.now + 1, end)
            snapshot = self.game.snapshot()
            self.health.follow(snapshot)
            for robot in snapshot.robots:
                self.game.robot_alive(robot)
            for session in [one.session for one in snapshot.players] + [one.session for one in snapshot.queue]:
                self.game.seen(session)

    def battle(self) -> None:
        """ada and bob fight."""
        self.players("ada", "bob", ready=True)
        self.pass_time(15)
        assert self.state["game"]["state"] == "playing"

    @property
    def state(self) -> dict[str, Any]:
        return {**self.game.overview(), "asked": self.asked[:]}

    def keep(self) -> list[str]:
        """Hand what was decided to the recorders, as the game's thread does; its kinds."""
        journal = self.referee.take_journal()
        self.log.record(journal, {})
        self.database.record(journal, self.referee.saved(self.now))
        return [type(one.event).__name__ for one in journal]


@pytest.fixture
def site(tmp_path: Path) -> Iterator[Site]:
    site = Site(tmp_path)
    yield site
    site.database.close()


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """ada and bob fight. For tests that change nothing."""
    site = Site(tmp_path_factory.mktemp("running"))
    site.battle()
    yield site
    site.database.close()


def refused(response: Any, *codes: int) -> str:
    """Why, in JSON."""
    assert response.status_code in codes, response.text
    assert response.content_type == "application/json"
    content = json.loads(response.text)
    assert list(content) == ["error"]
    assert content["error"]
    return str(content["error"])


def done(response: Any) -> None:
    assert (response.status_code, response.content_type, response.json) == (200, "application/json", {})


ROUTES = {
    ("GET", "/operator/api/state"): None,
    ("GET", "/operator/api/drive"): None,
    ("GET", "/operator/api/camera"): None,
    ("GET", "/operator/api/log.json"): None,
    ("GET", "/operator/api/log.csv"): None,
    ("POST", "/operator/api/battle"): {"action": "abort"},
    ("POST", "/operator/api/players/ada/sign_out"): {},
    ("POST", "/operator/api/names"): {"ban": "ada"},
    ("POST", "/operator/api/robots/0"): {"in_service": False},
    ("PUT", "/operator/api/rules"): {"hit_damage": 50},
    ("POST", "/operator/api/presets"): {"save": "ours"},
    ("POST", "/operator/api/vote"): {"choices": TWO},
    ("POST", "/operator/api/message"): {"text": "hello"},
}
DECISIONS = [route for route in ROUTES if route[0] != "GET"]


def unchanged(site: Site, before: dict[str, Any]) -> bool:
    return site.state == before


# who may


@pytest.mark.parametrize("route", ROUTES)
def test_without_the_token_nothing_is_shown_or_done(site: Site, route: tuple[str, str]) -> None:
    site.battle()
    before, (method, path) = site.state, route
    session = site.operator().get_cookie("laserbot_operator", path="/operator").value
    for number, headers in enumerate(
        (
            {},
            {"Authorization": "Bearer wrong"},
            {"Authorization": "Bearer "},
            {"Authorization": TOKEN},
            {"Authorization": f"Basic {TOKEN}"},
            {"Authorization": f"Bearer {session}"},
            {"Authorization": "Bearer " + "x" * 10_000},
            {"Authorization": "Bearer <b>\x7f"},
            {"Cookie": "laserbot_operator=wrong"},
            {"Cookie": f"laserbot_session={session}"},
            {"Cookie": f"laserbot_operator={TOKEN}"},
        )
    ):
        response = site.browser().open(
            path, method=method, json=ROUTES[route], headers=headers, environ_base={"REMOTE_ADDR": f"10.0.0.{number}"}
        )
        refused(response, 401)
    assert unchanged(site, before)


@pytest.mark.parametrize("route", DECISIONS)
def test_another_site_decides_nothing_whatever_cookie_comes_along(site: Site, route: tuple[str, str]) -> None:
    site.battle()
    operator, before, (method, path) = site.operator(), site.state, route
    for origin in ("http://evil.example", "null", "http://localhost:8080", ""):
        refused(operator.open(path, method=method, json=ROUTES[route], headers={"Origin": origin}), 403)
    assert unchanged(site, before)
    done(operator.open(path, method=method, json=ROUTES[route], headers={"Origin": "http://localhost"}))
    assert not unchanged(site, before)


def test_the_token_itself_serves_programs(site: Site) -> None:
    state = site.browser().get("/operator/api/state", headers=BEARER)
    assert (state.status_code, state.json["operator"]) == (200, "operator")


def test_without_a_token_there_is_no_desk(tmp_path: Path) -> None:
    site = Site(tmp_path, token="")
    browser = site.browser()
    for headers in ({}, {"Authorization": "Bearer "}, {"Cookie": "laserbot_operator="}):
        assert "LASERBOT_OPERATOR_TOKEN" in refused(browser.get("/operator/api/state", headers=headers), 404)
    assert refused(browser.post("/operator/login", json={"token": ""}), 404)
    assert browser.post("/operator/login", data={"token": ""}).status_code == 404
    assert browser.get("/operator").text == "no token"
    site.database.close()


def test_signing_in_by_the_form_leads_to_the_desk_and_out_again(site: Site) -> None:
    browser = site.browser()
    assert browser.get("/operator").text == "sign in: None"
    response = browser.post("/operator/login", data={"token": TOKEN, "name": " Ann "})
    assert (response.status_code, response.headers["Location"]) == (303, "/operator")
    cookie = response.headers["Set-Cookie"]
    assert {"HttpOnly", "SameSite=Strict", "Path=/operator", "Max-Age=43200"} <= set(cookie.split("; "))
    assert TOKEN not in cookie
    assert browser.get("/operator").text == "desk of Ann"
    assert browser.get("/operator/api/state").json["operator"] == "Ann"
    old = browser.get_cookie("laserbot_operator", path="/operator").value
    assert browser.post("/operator/logout").status_code == 303
    assert browser.get("/operator").text == "sign in: None"
    refused(browser.get("/operator/api/state", headers={"Cookie": f"laserbot_operator={old}"}), 401)


def test_a_session_ends_after_twelve_hours_and_only_so_many_are_kept(site: Site) -> None:
    first = site.operator()
    site.now += SESSION_LIFE - 1
    assert first.get("/operator/api/state").status_code == 200
    site.now += 1
    refused(first.get("/operator/api/state"), 401)
    second = site.operator()
    for _ in range(MAX_SESSIONS):
        assert second.get("/operator/api/state").status_code == 200
        site.operator()
    refused(second.get("/operator/api/state"), 401)


@pytest.mark.parametrize(
    "given",
    [{}, {"token": 1}, {"token": None}, {"token": ""}, {"token": TOKEN, "name": "x" * 33}, {"token": TOKEN, "name": 5},
     {"token": TOKEN, "name": "a\nb"}, {"token": TOKEN, "name": "a\u202eb"}, {"token": TOKEN, "more": 1}],
)  # fmt: skip
def test_an_impossible_login_is_refused(site: Site, given: dict[str, Any]) -> None:
    response = site.browser().post("/operator/login", json=given)
    refused(response, 400)
    assert "Set-Cookie" not in response.headers
    if all(isinstance(value, str) for value in given.values()) and "more" not in given:
        response = site.browser().post("/operator/login", data=given)
        assert response.status_code == 400
        assert response.text.startswith("sign in: ")
        assert "Set-Cookie" not in response.headers


def test_who_guesses_the_token_is_slowed_down_and_nobody_who_knows_it(
    site: Site, caplog: pytest.LogCaptureFixture
) -> None:
    browser = site.browser()
    for _ in range(5):
        refused(browser.post("/operator/login", json={"token": "guess"}), 401)
    for response in (
        browser.post("/operator/login", json={"token": "guess"}),
        browser.get("/operator/api/state", headers={"Authorization": "Bearer guess"}),
        browser.post("/operator/login", data={"token": "guess"}),
    ):
        assert response.status_code == 429
        assert response.headers["Retry-After"] == "1"
    assert caplog.messages == ["/operator/login from 127.0.0.1 refused: that is not the operators' token"] * 5
    assert browser.get("/operator/api/state", headers=BEARER).status_code == 200
    assert browser.post("/operator/login", data={"token": TOKEN}).status_code == 303
    assert browser.post("/operator/login", json={"token": TOKEN}).status_code == 204
    elsewhere = {"REMOTE_ADDR": "10.0.0.9"}
    refused(browser.post("/operator/login", json={"token": "guess"}, environ_base=elsewhere), 401)
    site.now += 1
    refused(browser.post("/operator/login", json={"token": "guess"}), 401)


def test_who_is_signed_in_already_goes_on_while_others_guess(site: Site) -> None:
    operator = site.operator()
    for _ in range(9):
        site.browser().post("/operator/login", json={"token": "guess"})
    assert operator.get("/operator/api/state").status_code == 200


# what is no request


@pytest.mark.parametrize("route", DECISIONS)
@pytest.mark.parametrize(
    "code, content, content_type",
    [
        (415, b"", None),
        (400, b"", "application/json"),
        (400, b"null", "application/json"),
        (400, b"[]", "application/json"),
        (400, b'"text"', "application/json"),
        (400, b"{", "application/json"),
        (400, b"\xff\x00\xfe", "application/json"),
        (400, b"[" * 100_000, "application/json"),
        (400, b'{"<script>alert(1)</script>": 1}', "application/json"),
        (400, b'{"\\ud800\\u0000\\u202e": "x"}', "application/json"),
        (400, b'{"in_service": 9' + b"9" * 5000 + b"}", "application/json"),
        (415, b'{"text": "hello"}', "text/plain"),
        (415, b"text=hello&action=abort", "application/x-www-form-urlencoded"),
        (413, b'{"text": "' + HUGE.encode() + b'"}', "application/json"),
    ],
)
def test_what_is_no_json_object_is_refused(
    running: Site, route: tuple[str, str], code: int, content: bytes, content_type: str | None
) -> None:
    operator, before, (method, path) = running.operator(), running.state, route
    refused(operator.open(path, method=method, data=content, content_type=content_type), code)
    assert unchanged(running, before)


IMPOSSIBLE: dict[tuple[str, str], list[dict[str, Any]]] = {
    ("POST", "battle"): [
        {}, {"action": None}, {"action": "Start"}, {"action": ""}, {"action": "<b>"}, {"action": 1},
        {"action": ["pause"]}, {"action": "add_time"}, {"action": "pause", "seconds": 5},
        *({"action": "add_time", "seconds": seconds}
          for seconds in (0, 0.5, -1, 3601, True, None, "60", [60], float("nan"), float("inf"))),
    ],
    ("POST", "players/ada/sign_out"): [{"name": "bob"}, {"by": "Ann"}],
    ("POST", "names"): [
        {}, {"ban": "ada", "unban": "ada"}, {"ban": 1}, {"ban": ""}, {"ban": "a  b"}, {"ban": "<b>"}, {"ban": "x" * 17},
        {"ban": "a\u0000"}, {"unban": None}, {"words": "damn"}, {"words": {}}, {"words": [1]}, {"words": [None]},
        {"words": [["x"]]}, {"words": [""]}, {"words": [" "]}, {"words": ["x" * 33]}, {"words": ["a\nb"]},
        {"words": ["\ud800"]}, {"words": ["x"] * 1001},
    ],
    ("POST", "robots/0"): [{}, {"in_service": 0}, {"in_service": "false"}, {"in_service": None}, {"out": True},
        {"bot": "best"}, {"bot": ""}, {"bot": 1}, {"bot": ["easy"]}, {"bot": "easy", "in_service": True}],
    ("PUT", "rules"): [
        {"hit_damage": 0}, {"hit_damage": 101}, {"hit_damage": 10.5}, {"hit_damage": "10"}, {"hit_damage": True},
        {"hit_damage": [1]}, {"practice": 1}, {"practice": "true"}, {"countdown": 0}, {"countdown": float("nan")},
        {"countdown": 1e400}, {"seats": 129}, {"seats": -1}, {"robot_timeout": 5}, {"hit_damage": 20, "countdown": 0},
        {"hit_damage": 20, "none": 1},
    ],
    ("POST", "presets"): [
        {}, {"save": "a", "remove": "b"}, {"save": 1}, {"save": ""}, {"save": " "}, {"save": "x" * 33},
        {"save": "a\nb"}, {"apply": "children"},
    ],
    ("POST", "vote"): [
        {}, {"choices": "children"}, {"choices": TWO[:1]}, {"choices": [*TWO, TWO[0]]},
        {"choices": ["children", "beginners"]}, {"choices": [*TWO, {"name": "nobody's", "own": True}]},
        {"choices": [*TWO, {"name": "tournament", "own": True}]},
        *({"choices": TWO, "seconds": seconds} for seconds in (4, 601, True, "30", float("nan"), float("inf"))),
    ],
    ("POST", "message"): [
        {}, {"text": None}, {"text": 5}, {"text": ["x"]}, {"text": "x" * 201}, {"text": "a\nb"}, {"text": "a\u0007"},
        {"text": "a\u202eb"}, {"text": "\ud800"}, {"message": "x"},
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    "method, path, content", [(*route, content) for route, contents in IMPOSSIBLE.items() for content in contents]
)
def test_impossible_values_are_refused(running: Site, method: str, path: str, content: dict[str, Any]) -> None:
    operator, before = running.operator(), running.state
    assert len(refused(operator.open(f"/operator/api/{path}", method=method, json=content), 400)) < 300
    assert unchanged(running, before)


@pytest.mark.parametrize(
    "method, path, content",
    [
        ("POST", "players/nobody/sign_out", {}),
        ("POST", "players/%3Cb%3E/sign_out", {}),
        ("POST", "players/a%0Ab%00/sign_out", {}),
        ("POST", "players/" + "x" * 10_000 + "/sign_out", {}),
        ("POST", "players/ada", {}),
        ("POST", "robots/7", {"in_service": False}),
        ("POST", "robots/x", {"in_service": False}),
        ("POST", "robots/-1", {"in_service": False}),
        ("POST", "robots/" + "9" * 5000, {"in_service": False}),
        ("POST", "robots/%D9%A0", {"in_service": False}),
        ("POST", "names", {"unban": "ada"}),
        ("GET", "nothing", None),
        ("POST", "%3Cscript%3E", {}),
    ],
)
def test_what_is_not_there_is_not_found(running: Site, method: str, path: str, content: dict[str, Any] | None) -> None:
    operator, before = running.operator(), running.state
    refused(operator.open(f"/operator/api/{path}", method=method, json=content), 404)
    assert unchanged(running, before)


@pytest.mark.parametrize("route", ROUTES)
def test_a_wrong_method_is_refused_in_json(running: Site, route: tuple[str, str]) -> None:
    for method in {"GET", "POST", "PUT", "DELETE", "PATCH"} - {route[0]}:
        response = running.operator().open(route[1], method=method, json={})
        refused(response, 405)
        assert route[0] in response.headers["Allow"]


def act(site: Site, operator: Any, action: str, **fields: Any) -> Any:
    return operator.post("/operator/api/battle", json={"action": action, **fields})


def test_at_the_wrong_moment_nothing_is_decided(site: Site) -> None:
    operator = site.operator()

    def wrong(*actions: str) -> None:
        before = site.state
        for action in actions:
            refused(act(site, operator, action, **({"seconds": 60} if action == "add_time" else {})), 409)
        assert unchanged(site, before)

    site.players("ada")
    wrong("start", "abort", "pause", "resume", "add_time")
    site.players("ada", "bob", ready=True)
    assert site.state["game"]["state"] == "countdown"
    wrong("resume")
    done(act(site, operator, "pause"))
    wrong("pause")
    done(act(site, operator, "start"))
    wrong("start", "resume")
    done(act(site, operator, "abort"))
    wrong("abort", "pause", "resume", "add_time")


# what is decided


def test_pause_more_time_and_resume(site: Site) -> None:
    site.battle()
    operator = site.operator()
    left = site.state["game"]["time_left"]
    done(act(site, operator, "pause"))
    site.pass_time(100)
    assert (site.state["game"]["paused"], site.state["game"]["time_left"]) == (True, left)
    done(act(site, operator, "add_time", seconds=60.5))
    done(act(site, operator, "resume"))
    site.pass_time(10)
    assert (site.state["game"]["paused"], site.state["game"]["time_left"]) == (False, left + 50.5)


def test_a_player_is_signed_out(site: Site) -> None:
    site.players("ada", "bob", "cy", "Dörte")
    operator = site.operator()
    done(operator.post("/operator/api/players/D%C3%B6rte/sign_out", json={}))
    done(operator.post("/operator/api/players/ada/sign_out", json={}))
    assert [player["name"] for player in site.state["players"]] == ["bob", "cy"]
    assert site.state["queue"] == []


def test_names_are_banned_allowed_again_and_searched_for_words(site: Site) -> None:
    site.players("ada")
    operator, visitor = site.operator(), site.browser()
    done(operator.post("/operator/api/names", json={"ban": "ADA"}))
    done(operator.post("/operator/api/names", json={"words": ["Damn", "damn", "Damn"]}))
    assert site.state["players"] == []
    assert site.state["names"] == {"banned": ["ADA"], "words": ["Damn", "damn"]}
    for name, why in (("ada", "banned"), ("GODDAMN", "not allowed")):
        response = visitor.post("/signUpUser", data={"data": name})
        content = json.loads(response.text)
        assert (response.status_code, content["status"]) == (403, "ERROR")
        assert why in content["error"]
    assert site.state["players"] == []
    done(operator.post("/operator/api/names", json={"unban": "ada"}))
    done(operator.post("/operator/api/names", json={"words": []}))
    assert site.state["names"] == {"banned": [], "words": []}
    assert json.loads(visitor.post("/signUpUser", data={"data": "ada"}).text)["status"] == "OK"


def test_a_thousand_words_of_any_script_fit(site: Site) -> None:
    words = [f"{number:04}" + "語" * 28 for number in range(1000)]
    done(site.operator().post("/operator/api/names", json={"words": words}))
    assert site.state["names"]["words"] == words


def test_a_robot_is_given_to_a_bot_and_taken_back(site: Site) -> None:
    operator, bots = site.operator(), site.browser()
    state = operator.get("/operator/api/state").json
    assert state["bots"] == {"program": "absent", "levels": ["easy", "fair", "hard"]}
    assert json.loads(bots.post("/bots", data={"sees": "1"}).text) == {"status": "OK", "robots": {}}
    done(operator.post("/operator/api/robots/1", json={"bot": "fair"}))
    assert json.loads(bots.post("/bots", data={"sees": "1"}).text) == {"status": "OK", "robots": {"1": "fair"}}
    site.game.sign_up("Bot1", "session of Bot1", 0, wanted=1)
    state = operator.get("/operator/api/state").json
    assert [(robot["bot"], robot["player"]) for robot in state["robots"]] == [
        (None, None),
        ("fair", "Bot1"),
        (None, None),
    ]
    assert state["bots"]["program"] == "ready"
    done(operator.post("/operator/api/robots/1", json={"bot": None}))
    state = operator.get("/operator/api/state").json
    assert (state["robots"][1]["bot"], state["robots"][1]["player"]) == (None, None)


def test_the_desk_knows_bots_that_see_nothing_and_those_that_are_gone(site: Site) -> None:
    bots = site.browser()

    def after(seconds: int, sees: str) -> str:
        for _ in range(seconds):
            site.now += 1
            bots.post("/bots", data={"sees": sees})
        return str(site.bots.state())

    assert after(3, "0") == "ready", "they may have just begun to look"
    assert after(5, "0") == "blind"
    assert after(1, "1") == "ready"
    site.now += 6
    assert site.bots.state() == "absent"


def test_a_robot_goes_out_of_service_and_back(site: Site) -> None:
    site.players("ada", "bob", "cy")
    operator = site.operator()
    done(operator.post("/operator/api/robots/1", json={"in_service": False}))
    robot = operator.get("/operator/api/state").json["robots"][1]
    assert (robot["id"], robot["name"], robot["player"], robot["in_service"]) == (1, "pi1", None, False)
    assert [waiter["name"] for waiter in site.state["queue"]] == ["bob"]
    done(operator.post("/operator/api/robots/1", json={"in_service": True}))
    assert site.state["robots"][1]["offered_to"] == "bob"


def test_rules_change_at_once_all_or_none_and_back(site: Site) -> None:
    site.battle()
    operator = site.operator()
    done(operator.put("/operator/api/rules", json={"hit_damage": 60, "practice": False, "countdown": 2.5}))
    rules = operator.get("/operator/api/state").json["rules"]
    assert rules["hit_damage"] == {
        "value": 60, "default": 10, "min": 1, "max": 100, "words": [], "text": "life (of 100) that a hit takes",
        "idle": False,
    }  # fmt: skip
    assert (rules["practice"]["value"], rules["practice"]["min"], rules["countdown"]["value"]) == (False, None, 2.5)
    site.game.hit(1)
    assert [player["life"] for player in site.state["players"]] == [100, 40]
    done(operator.put("/operator/api/rules", json={"hit_damage": None}))
    assert site.state["rules"]["hit_damage"]["value"] == 10


def test_rules_are_kept_as_a_preset_and_hold_again(site: Site) -> None:
    operator = site.operator()
    done(operator.put("/operator/api/rules", json={"hit_damage": 60}))
    done(operator.post("/operator/api/presets", json={"save": "Our evening"}))
    presets = {one["name"]: one for one in operator.get("/operator/api/state").json["presets"]}
    assert {name for name, one in presets.items() if not one["own"]} == {
        "children", "beginners", "tournament", "short_rounds",
    }  # fmt: skip
    done(operator.put("/operator/api/rules", json=presets["children"]["rules"]))
    assert (site.referee.saved(0.0)["rules"]["hit_damage"], site.state["rules"]["countdown"]["value"]) == (5, 20)
    done(operator.put("/operator/api/rules", json=presets["Our evening"]["rules"]))
    rules = site.state["rules"]
    assert {name: rule["value"] for name, rule in rules.items() if rule["value"] != rule["default"]} == {
        "hit_damage": 60,
    }  # fmt: skip
    done(operator.post("/operator/api/presets", json={"remove": "Our evening"}))
    refused(operator.post("/operator/api/presets", json={"remove": "children"}), 404)


def test_the_audience_is_asked_to_vote_until_the_operator_ends_it(site: Site) -> None:
    operator = site.operator()
    refused(operator.post("/operator/api/vote", json={"choices": []}), 409)
    done(operator.post("/operator/api/vote", json={"choices": TWO, "seconds": 60}))
    done(operator.post("/operator/api/vote", json={"choices": []}))
    opened, ended = map(json.loads, site.asked)
    assert opened["number"] == ended["number"]
    assert opened["choices"] == ended["choices"] == [["children", False], ["beginners", False]]
    assert 59 < opened["ends_at"] - ended["ends_at"] <= 60
    done(operator.post("/operator/api/vote", json={"choices": TWO}))
    assert json.loads(site.asked[-1])["number"] > opened["number"]


def test_a_message_is_shown_and_taken_back(site: Site) -> None:
    operator = site.operator()
    done(operator.post("/operator/api/message", json={"text": " <b>Pause</b> bis 15:00 ☕ "}))
    assert site.game.snapshot().message == "<b>Pause</b> bis 15:00 ☕"
    done(operator.post("/operator/api/message", json={"text": ""}))
    assert site.game.snapshot().message == ""


def test_what_is_so_already_is_no_event(site: Site) -> None:
    operator = site.operator()
    for method, path, content in (
        ("POST", "names", {"ban": "ada"}),
        ("POST", "names", {"words": ["x"]}),
        ("POST", "robots/0", {"in_service": False}),
        ("PUT", "rules", {"hit_damage": 50}),
        ("POST", "presets", {"save": "ours"}),
        ("POST", "message", {"text": "hello"}),
    ):
        site.keep()
        done(operator.open(f"/operator/api/{path}", method=method, json=content))
        assert len(site.keep()) == 1
        done(operator.open(f"/operator/api/{path}", method=method, json=content))
        assert site.keep() == []


# a tournament


def order(operator: Any, **fields: Any) -> Any:
    return operator.post("/operator/api/tournament", json=fields)


def test_a_tournament_is_led_by_programs_too_and_each_step_is_kept(site: Site) -> None:
    operator = site.operator()
    names = ["ada", "bob", "cy", "dee"]
    site.players("ada", "dee")
    done(order(operator, action="open", names=names, best_of=3, third=True, patience=60))
    done(order(operator, action="call"))
    done(order(operator, action="no_show", number=1, name="dee"))
    done(order(operator, action="correct", number=1, winner="dee", reason="was there"))
    done(order(operator, action="close"))
    assert site.keep()[-5:] == ["TournamentOpened", "MatchCalled", "NoShow", "MatchCorrected", "TournamentClosed"]
    tournament = operator.get("/operator/api/state").json["tournament"]
    assert tournament["open"] is False
    assert [match["winner"] for match in tournament["matches"]] == ["dee", None, None, None]


@pytest.mark.parametrize(
    ("fields", "code"),
    [
        ({}, 400),
        ({"action": "begin"}, 400),
        ({"action": "open"}, 400),
        ({"action": "open", "names": "ada"}, 400),
        ({"action": "open", "names": ["ada"]}, 400),
        ({"action": "close", "number": 1}, 400),
        ({"action": "call", "number": "1"}, 400),
        ({"action": "call"}, 409),
        ({"action": "close"}, 409),
    ],
)
def test_what_no_tournament_can_do_is_refused(site: Site, fields: dict[str, Any], code: int) -> None:
    response = order(site.operator(), **fields)
    assert response.status_code == code
    assert response.json["error"]
    assert site.state["tournament"] is None


def test_a_match_or_a_player_that_there_is_not_is_not_found(site: Site) -> None:
    operator = site.operator()
    done(order(operator, action="open", names=["ada", "bob", "cy", "dee"]))
    assert order(operator, action="call", number=9).status_code == 404
    assert order(operator, action="no_show", number=1, name="bob").status_code == 404


# what is shown


def test_the_state_has_all_that_is_promised(site: Site) -> None:
    site.battle()
    site.players("cy", "dee")
    state = site.operator().get("/operator/api/state").json
    assert state.keys() == {
        "time", "game", "robots", "players", "queue", "rules", "presets", "names", "tournament", "database", "versions",
        "visitors", "operator", "log", "has_journal", "bots", "overhead",
    }  # fmt: skip
    assert state["game"].keys() == {"state", "paused", "why_no_start", "time_left", "battle", "notice", "message"}
    assert state["robots"][0].keys() >= {
        "id", "name", "player", "offered_to", "in_service", "ping_age", "linked", "health", "bot",
    }  # fmt: skip
    assert state["players"][0].keys() == {
        "name", "robot", "life", "ready", "avatar", "team", "shots", "hits", "kills", "seat_left", "page_age",
    }  # fmt: skip
    assert state["queue"] == [{"name": "dee", "place": 1, "offer": None, "seconds": pytest.approx(185)}]
    assert state["rules"].keys() == DECLARED.keys()
    assert (state["database"]["problem"], state["database"]["mishap"]) == ("", "")
    assert state["visitors"] == {"one_address": ""}
    assert state["versions"].keys() == {"laserbot", "python", "ros", "database"}
    assert state["versions"]["database"].startswith("sqlite 3.")


def test_visitors_who_seem_to_have_one_address_are_told_of(site: Site) -> None:
    for number in range(MANY):
        site.browser().post("/signUpUser", data={"data": f"ann{number}"}, environ_base={"REMOTE_ADDR": "10.42.0.1"})
    assert site.operator().get("/operator/api/state").json["visitors"] == {"one_address": "10.42.0.1"}


def test_troubles_of_the_camera_above_the_floor_are_told(site: Site) -> None:
    site.overhead.append("floor tag 200 is missing")
    assert site.operator().get("/operator/api/state").json["overhead"] == {"troubles": ["floor tag 200 is missing"]}


def test_no_password_is_shown(tmp_path: Path) -> None:
    site = Site(tmp_path, LASERBOT_DATABASE="postgresql+pg8000://op:secret@host/game")
    state = site.operator().get("/operator/api/state")
    assert state.json["database"]["url"] == "postgresql+pg8000://op@host/game"
    site.database.close()


def test_no_session_is_shown(site: Site) -> None:
    site.battle()
    site.keep()
    operator = site.operator()
    for path in ("state", "log.json", "log.csv"):
        assert "session of" not in operator.get(f"/operator/api/{path}").text


def test_every_decision_is_in_the_log_with_its_time_and_who(site: Site) -> None:
    site.battle()
    operator = site.operator("Ann")
    site.keep()
    for action in ("pause", "resume", "abort"):
        done(act(site, operator, action))
    done(operator.post("/operator/api/names", json={"ban": "ada"}))
    assert operator.get("/operator/api/drive").status_code == 200
    assert operator.get("/operator/api/camera").status_code == 200  # who looks decides nothing
    done(operator.post("/operator/api/message", json={"text": "=hello"}))
    site.keep()
    log = operator.get("/operator/api/state").json["log"]
    assert [(entry["kind"], entry["by"]) for entry in log[:7]] == [
        ("MessageShown", "Ann"), ("DriveTaken", "Ann"), ("Left", "Ann"), ("NameBanned", "Ann"), ("BattleEnded", "Ann"),
        ("Resumed", "Ann"), ("Paused", "Ann"),
    ]  # fmt: skip
    assert log[7]["by"] is None
    assert log[0]["text"] == "message to everybody: =hello (by Ann)"
    assert all(isinstance(entry["at"], float) for entry in log)
    assert len(log) <= 50


def test_the_whole_log_comes_from_the_database(site: Site) -> None:
    operator = site.operator("=Ann")
    assert operator.get("/operator/api/log.json").json == []
    site.battle()
    for _ in range(600):
        done(operator.post("/operator/api/message", json={"text": "one"}))
        done(operator.post("/operator/api/message", json={"text": "two"}))
    kinds = site.keep()
    until(lambda: len(operator.get("/operator/api/log.json").json) == len(kinds), 20, "all is written")
    log = operator.get("/operator/api/log.json")
    assert log.content_type == "application/json"
    assert [entry["kind"] for entry in log.json] == kinds
    assert log.json[-1]["data"] == {"text": "two", "by": "=Ann"}
    assert log.json[-1].keys() == {"at", "kind", "text", "by", "data"}
    table = operator.get("/operator/api/log.csv")
    assert table.content_type == "text/csv; charset=utf-8"
    rows = list(csv.DictReader(io.StringIO(table.text)))
    assert [row["kind"] for row in rows] == kinds
    assert rows[-1]["by"] == "'=Ann", "no spreadsheet computes it"
    assert json.loads(rows[-1]["data"]) == {"text": "two", "by": "=Ann"}


def test_the_newest_of_the_log_outlive_the_program(site: Site) -> None:
    site.battle()
    site.keep()
    site.database.close()
    again = EventLog(site.database)
    again.open()
    assert [(entry["kind"], entry["text"]) for entry in again.latest()] == [
        (entry["kind"], entry["text"]) for entry in site.log.latest()
    ]


def test_without_the_database_only_the_download_fails(site: Site, tmp_path: Path) -> None:
    operator = site.operator()
    site.database.close()
    (tmp_path / "game.db").unlink()
    for suffix in ("-wal", "-shm"):
        (tmp_path / f"game.db{suffix}").unlink(missing_ok=True)
    for path in ("log.json", "log.csv"):
        assert "database" in refused(operator.get(f"/operator/api/{path}"), 503)
    assert operator.get("/operator/api/state").status_code == 200


@pytest.mark.parametrize(("what", "port"), [("drive", 9191), ("camera", 9192)])
def test_a_ticket_for_a_test_drive_or_the_cameras_is_good_for_seconds(site: Site, what: str, port: int) -> None:
    content = site.operator().get(f"/operator/api/{what}").json
    assert content["port"] == port
    end = int(content["ticket"].partition(".")[0])
    assert is_operator_ticket(content["ticket"], TOKEN, end - 1)
    assert not is_operator_ticket(content["ticket"], TOKEN, end + 1)
    assert not is_operator_ticket(content["ticket"], "another token", end - 1)
    assert TOKEN not in content["ticket"]


BOARD = {"major": 1, "minor": 0, "mode": 0, "supply": 4950, "deaf": False}
HEALTHY = {"cpu": 0.2, "temperature": 48.5, "wifi": -55, "under_voltage": False, "board": BOARD}


def test_the_logs_of_all_hosts_are_shown_where_there_are_any(site: Site, tmp_path: Path) -> None:
    assert not site.operator().get("/operator/api/state").get_json()["has_journal"]
    assert site.operator().get("/operator/api/journal").status_code == 404
    journal = tmp_path / "journal"
    desk = Site(tmp_path, LASERBOT_JOURNAL=str(journal)).operator()
    assert desk.get("/operator/api/state").get_json()["has_journal"]
    assert desk.get("/operator/api/journal").status_code == 503
    write_journal(journal, "raspberrypi1", [from_container("laserbot-robot", "ready"), KERNEL])
    write_journal(journal, "raspberrypi2", [from_container("laserbot-robot", "ready, too")])

    def told(query: str = "") -> list[str]:
        answer = desk.get(f"/operator/api/journal?{query}").get_json()
        assert answer["hosts"] == ["raspberrypi1", "raspberrypi2"]
        return sorted(line["text"] for line in answer["lines"])

    assert told() == ["Under-voltage detected!", "ready", "ready, too"]
    assert told("only=warnings") == ["Under-voltage detected!"]
    assert told("host=raspberrypi2") == ["ready, too"]


def test_how_robots_are_is_shown_with_what_needs_a_hand(site: Site) -> None:
    operator = site.operator()
    site.health.report(0, HEALTHY)
    site.health.report(1, {**HEALTHY, "under_voltage": True, "board": {**BOARD, "supply": 4299, "deaf": True}})

    def shown() -> list[Any]:
        return [robot["health"] for robot in operator.get("/operator/api/state").json["robots"]]

    healthy, sick, unknown = shown()
    assert healthy == {**HEALTHY, "age": 0.0, "warnings": []}
    assert sick["warnings"] == ["low_supply", "under_voltage", "deaf"]
    assert unknown is None
    assert site.health.weak() == {1}
    site.pass_time(6)
    assert shown()[0]["warnings"] == ["silent"]
    assert site.health.weak() == set()


def test_an_original_board_is_not_missed_and_no_reading_is_no_warning(site: Site) -> None:
    site.health.report(0, {**HEALTHY, "board": None})
    site.health.report(1, {**HEALTHY, "board": {**BOARD, "supply": 0}})
    assert site.health.of(0) == {**HEALTHY, "board": None, "age": 0.0, "warnings": []}
    assert site.health.weak() == set()


def test_a_supply_is_low_by_its_fall_below_what_was_usual(site: Site) -> None:
    """An Arduino's own reference is 10 % exact: 5 V may be told as 4.5 or 5.5."""
    usual = {0: 4500, 1: 5500}

    def told(parts: float) -> list[list[str]]:
        for robot, supply in usual.items():
            site.health.report(robot, {**HEALTHY, "board": {**BOARD, "supply": round(supply * parts)}})
        site.pass_time(1)
        return [known["warnings"] for robot in usual if (known := site.health.of(robot))]

    for second in range(62):
        assert told(0.97 if second % 10 == 5 else 1) == [[], []], "motors pull it down for moments"
    assert told(0.96) == [[], []]
    assert told(0.91) == [["low_supply"]] * 2
    assert site.health.weak() == {0, 1}
    for _ in range(60):
        told(0.91)
    assert told(0.91) == [["low_supply"]] * 2, "nobody gets used to it"
    site.health.forget(1)
    assert told(0.91) == [["low_supply"], []], "another battery, perhaps"


def test_a_robot_in_another_light_than_the_rules_is_shown_after_a_moment(site: Site) -> None:
    operator = site.operator()
    boards = {0: {**BOARD, "mode": 1}, 1: BOARD, 2: None}

    def told(seconds: int) -> list[list[str]]:
        for _ in range(seconds):
            site.pass_time(1)
            for robot, board in boards.items():
                site.health.report(robot, {**HEALTHY, "board": board})
        return [robot["health"]["warnings"] for robot in operator.get("/operator/api/state").json["robots"]]

    assert told(4) == [[], [], []]
    assert told(2) == [["wrong_light"], [], []]
    done(operator.put("/operator/api/rules", json={"light": "coded"}))
    assert told(4) == [[], [], []]
    assert told(2) == [[], ["wrong_light"], ["wrong_light"]], "the original sketch stays plain"
    assert site.health.weak() == set()
    boards[1] = {**BOARD, "mode": 1}
    assert told(1) == [[], [], ["wrong_light"]]


def test_a_robot_is_asked_to_show_itself(site: Site) -> None:
    operator = site.operator()
    site.deaf = {2}
    done(operator.post("/operator/api/robots/1/identify", json={}))
    assert "listens" in refused(operator.post("/operator/api/robots/2/identify", json={}), 409)
    assert refused(operator.post("/operator/api/robots/9/identify", json={}), 404)
    assert refused(operator.post("/operator/api/robots/x/identify", json={}), 404)
    assert refused(operator.post("/operator/api/robots/1/identify", json={"how": "loud"}), 400)
    assert refused(site.browser().post("/operator/api/robots/1/identify", json={}), 401)
    assert site.identified == [1]


def test_words_are_values_of_rules_and_only_those_that_there_are(site: Site) -> None:
    operator = site.operator()
    done(operator.put("/operator/api/rules", json={"light": "coded", "teams": 2, "friendly_fire": True}))
    rules = operator.get("/operator/api/state").json["rules"]
    assert (rules["light"]["value"], rules["light"]["words"]) == ("coded", ["plain", "coded"])
    assert rules["teams"]["value"] == 2
    for wrong in ({"light": "bright"}, {"light": 1}, {"teams": 1}, {"teams": 5}, {"teams": "2"}, {"friendly_fire": 1}):
        assert refused(operator.put("/operator/api/rules", json=wrong), 400)
