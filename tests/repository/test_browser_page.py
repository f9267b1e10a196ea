"""docs/protocol-browser.md against the web application and rosbridge's clients: its conversations are held."""

import json
import re
from io import BytesIO
from typing import Any

import pytest
from flask.testing import FlaskClient

from laser_bot_battle.names import GAME_STATUS
from server.access.identity import GUEST, session_identity
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.robot_health import RobotsHealth
from server.game.rules import Rules
from server.messages.types import Types
from server.pages.app import create_pages
from server.pages.audience import Audience
from server.ros.status import to_message
from server.rosbridge.delivery import Delivery
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import Effect, Publish, Send
from server.rosbridge.gate import STATUS_TYPE, Gate
from server.rosbridge.graph import Graph
from server.rosbridge.protocol import Client
from server.store.results import Results
from server.web.bots import BotsProgram, create_bots
from server.web.settings import Settings
from server.web.watch import create_watch
from tcpros.clock import Clock
from tests.support.documents import blocks, page, table
from tests.support.linked import add_linked_robot
from tests.support.site import whole_site

PAGE = page("protocol-browser.md")
COOKIE = "laserbot_session"


class Story:
    """A server with three robots, the people of the page with their browsers and WebSockets, and a clock of its own."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.battle = GameLoop(Referee(Rules()), clock=lambda: self.now)
        for number in range(3):
            add_linked_robot(self.battle, f"/id_service_client_raspberrypi{number + 1}")
        settings = Settings.from_env({})
        bots = create_bots(self.battle, BotsProgram(lambda: self.now))
        self.app = whole_site(self.battle, settings, create_watch(self.battle, RobotsHealth()), bots)
        self.gate, self.drivers, self.graph, self.types = Gate(""), Drivers(), Graph(), Types()
        self._browsers: dict[str, FlaskClient] = {}
        self._clients: dict[str, Client] = {}

    def browser(self, who: str) -> FlaskClient:
        return self._browsers.setdefault(who, self.app.test_client())

    def client(self, who: str) -> Client:
        """That person's WebSocket, opened with the browser's cookie."""
        if who not in self._clients:
            cookie = self.browser(who).get_cookie(COOKIE)
            identity = session_identity(cookie.value) if cookie else GUEST
            self._clients[who] = Client(self.gate, self.drivers, self.graph, self.types, Clock(), identity)
        return self._clients[who]

    def wait(self, seconds: float) -> None:
        """Time passes; robots and pages give signs of life."""
        end = self.now + seconds
        while self.now < end:
            self.now = min(self.now + 0.4, end)
            for robot in self.battle.snapshot().robots:
                self.battle.robot_alive(robot)
            for browser in self._browsers.values():
                browser.get("/session")

    def request(self, who: str, method: str, path: str, fields: str) -> str:
        form = dict(field.split("=", 1) for field in fields.split())
        response = self.browser(who).open(path, method=method, data=form if method == "POST" else None)
        # a ticket is never the same twice
        return f"{response.status_code} " + re.sub(r'"[0-9]+\.[0-9a-f]{64}"', '"…"', response.text)

    def says(self, who: str, text: str) -> list[str]:
        """What follows from that request over the WebSocket, as lines of the page."""
        self.gate.update(to_message(self.battle.snapshot()), self.now)
        return self.lines(who, self.client(who).receive(text, self.now))

    def status(self, who: str) -> list[str]:
        """What that person gets when the referee speaks."""
        status = BytesIO()
        to_message(self.battle.snapshot()).serialize(status)
        message = Delivery(self.types.message(STATUS_TYPE), self.gate.public(status.getvalue()), 0)
        client = self.client(who)
        (subscription,) = [one for one in self.graph.subscriptions(GAME_STATUS) if one.client is client]
        assert subscription.offer(message, self.now) is message
        _, brace, text = message.frames(subscription.form).partition(b"{")  # what is before it is the WebSocket's
        return [f"{who} <- {(brace + text).decode()}"]

    def lines(self, who: str, effects: list[Effect]) -> list[str]:
        lines = []
        for effect in effects:
            if isinstance(effect, Send):
                lines.append(f"{who} <- {effect.data!s}")
            if isinstance(effect, Publish):
                message_type = self.graph.type_of(effect.topic) or self.types.message("laser_bot_battle/Robot_msg")
                lines.append(f"ROS {effect.topic} {message_type.json(effect.data)}")
        return lines


def plain(line: str) -> Any:
    """A line of the page with its JSON read, so that spaces in it do not count."""
    head, brace, rest = line.partition("{")
    return head, json.loads(brace + rest) if brace else None


def hold(story: Story, paragraph: str) -> None:
    """Do what the first line of the paragraph says; the others must be what follows."""
    first, *expected = paragraph.splitlines()
    match first.split(" ", 3):
        case [seconds, "s", "later"]:
            story.wait(float(seconds))
            assert not expected
        case [who, "GET" | "POST" as method, path, *fields]:
            # an answer's text counts to the letter
            assert [story.request(who, method, path, *fields or [""])] == expected
        case [who, "->", *words]:
            assert [plain(line) for line in story.says(who, " ".join(words))] == [plain(line) for line in expected]
        case [who, "closes"]:
            lines = story.lines(who, story.client(who).closed())
            assert [plain(line) for line in lines] == [plain(line) for line in expected]
        case [who, "<-", *_]:
            assert [plain(line) for line in story.status(who)] == [plain(first)]
        case _:
            pytest.fail(f"the page has a line that is no step: {first}")


def test_the_conversations_are_held_as_the_page_tells_them() -> None:
    story = Story()
    paragraphs = [part for block in blocks(PAGE, "conversation") for part in re.split(r"\n\n+", block.strip())]
    assert len(paragraphs) >= 30
    for paragraph in paragraphs:
        hold(story, paragraph)


# what has a page of its own
ELSEWHERE = ("static", "results.")


def test_the_page_has_every_route_and_no_other() -> None:
    settings = Settings.from_env({})
    apps = Story().app, create_pages(settings, Results(settings.database), Audience())
    rules = [rule for app in apps for rule in app.url_map.iter_rules() if not rule.endpoint.startswith(ELSEWHERE)]
    routes = {(method, rule.rule) for rule in rules for method in (rule.methods or set()) & {"GET", "POST"}}
    told = {(row["method"], path) for row in table(PAGE, "HTTP") for path in row["path"].split(", ")}
    assert told == routes


def test_the_page_has_every_operation_and_no_other() -> None:
    rows = table(PAGE, "rosbridge")
    known = set(Story().client("guest").handlers)
    assert {row["operation"] for row in rows if "client" in row["from"]} == known
    assert {row["operation"] for row in rows if "server" in row["from"]} == {
        "publish", "call_service", "service_response", "status", "fragment", "png",
    }  # fmt: skip
