"""The picture of the arena in a real browser: fed as by rosbridge, and on the simulator's own page."""

import json
import math
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.polling import until
from tests.support.programs import ROOT

STATIC = ROOT / "server" / "static"
WORDS = {section: json.loads((STATIC / "words" / "en.json").read_text())[section] for section in ("arena", "game")}
PICTURES = {f"img/avatar{number}.svg": f"img/avatar{number}.svg" for number in range(5)}
PAGE = f"""<!doctype html>
<html lang="en">
<link rel="icon" href="/static/img/favicon.svg">
<link rel="stylesheet" href="/static/css/arena.css">
<script type="application/json" id="words">{json.dumps(WORDS)}</script>
<script>globalThis.PICTURES = {json.dumps(PICTURES)};</script>
<div id="arena" class="arena" hidden><canvas role="img"></canvas><p>nobody</p></div>
<script type="module">
  import {{ ArenaView }} from "/static/js/arena/arena_view.js";
  import {{ fromTopic }} from "/static/js/battle/messages.js";
  window.heard = [];
  const view = new ArenaView(document.getElementById("arena"), (state) => heard.push(state));
  window.tell = (topic, message) => view.topics.find((one) => one.topic === topic).take(message);
  window.take = (status, me) => view.take(fromTopic(status), me);
</script>
"""
NAMES = ("Al", "Bea_the_Great_16", "Zoe", "Bob")
WALLS = [0, 0, 1.6, 0, 1.6, 0, 1.6, 1.2, 1.6, 1.2, 0, 1.2, 0, 1.2, 0, 0]
# what the picture has at a place of the floor, in m: [red, green, blue], 0 to 255
COLOUR = """([x, y]) => {
  const canvas = document.querySelector("canvas");
  const scale = canvas.width / 1.7;
  return [...canvas.getContext("2d").getImageData((x + 0.05) * scale, (1.25 - y) * scale, 1, 1).data].slice(0, 3);
}"""


class GamePage(ThreadingHTTPServer):
    """A port with a page that has the picture, the page's own scripts and avatars; remembers what was asked for."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        super().__init__((HOST, 0), partial(_Handler, directory=str(STATIC)))

    @property
    def url(self) -> str:
        return f"http://{HOST}:{self.server_port}/"


class _Handler(SimpleHTTPRequestHandler):
    server: GamePage

    def do_GET(self) -> None:
        self.server.asked.append(self.path)
        if self.path.startswith("/static/"):
            self.path = self.path.removeprefix("/static")
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(PAGE.encode())

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - as the base class calls it
        pass


@pytest.fixture(scope="module")
def game_page() -> Iterator[GamePage]:
    with GamePage() as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


@pytest.fixture(
    params=[
        (1280, 720),
        pytest.param((844, 390), marks=pytest.mark.slow),
        pytest.param((390, 844), marks=pytest.mark.slow),
    ],
    ids=["desktop", "landscape", "portrait"],
)
def sized(request: pytest.FixtureRequest, chromium: Browser, game_page: GamePage) -> Iterator[Page]:
    width, height = request.param
    with chromium.new_page(viewport={"width": width, "height": height}) as page:
        complaints: list[str] = []
        page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(game_page.url)
        page.wait_for_function("() => Boolean(window.take)")
        yield page
        assert complaints == []


def positions(*places: tuple[float, float]) -> dict[str, Any]:
    """A Positions as rosbridge writes it: the robots from 0 on at these places."""
    robots = [{"robot": number, "x": x, "y": y, "heading": 0.0} for number, (x, y) in enumerate(places)]
    return {"width": 1.6, "height": 1.2, "walls": WALLS, "robots": robots}


def status(*events: dict[str, Any], effects: int = 0) -> dict[str, Any]:
    """A GameStatus as rosbridge writes it: a battle of four on the robots 0 to 3, the last of whom is out; robot 2 has
    these effects of pick-ups."""
    users = [
        {
            "name": name,
            "robot": robot,
            "life": max(0, 100 - 34 * robot),
            "ready": True,
            "avatar": robot,
            "team": 0,
            "effects": effects * (robot == 2),
        }
        for robot, name in enumerate(NAMES)
    ]
    return {
        "game": 2, "time_left": 60, "battle": 1, "notice": "", "paused": False, "message": "", "practice": False,
        "queue": [], "users": users, "result": [], "events": list(events),
    }  # fmt: skip


RIM = 0.0525  # m, of a robot's chassis
SHIELD, RAYS = 0.0975, 0.114  # m from its middle
PLACES = ((0.3, 0.3), (0.8, 0.3), (0.3, 0.9), (1.3, 0.9), (1.3, 0.3))


def test_the_picture_has_the_robots_their_players_shots_and_hits(
    sized: Page, game_page: GamePage, screenshots: Path
) -> None:
    canvas = sized.locator("#arena canvas")
    expect(canvas).to_be_hidden()
    sized.evaluate("message => tell('/positions', message)", positions(*PLACES))
    expect(canvas).to_be_visible()
    expect(sized.locator("#arena p")).to_be_hidden()
    sized.evaluate("message => take(message, 'Al')", status())
    told = "Al 100%, Bea_the_Great_16 66%, Zoe 32%, Bob out, Robot 4"
    expect(canvas).to_have_attribute("aria-label", f"The arena seen from above, {told}")
    until(lambda: {f"/static/img/avatar{n}.svg" for n in range(4)} <= {*game_page.asked}, 10, "its avatars come")
    between = [0.55, 0.3]

    def is_red(place: list[float]) -> bool:
        sized.evaluate("message => tell('/positions', message)", positions(*PLACES))
        red, green, _ = sized.evaluate(COLOUR, place)
        return bool(red > 150 and red > green + 60)

    until(lambda: sum(sized.evaluate(COLOUR, between)) > 0, 10, "the floor is drawn")
    assert not is_red(between)

    def shines() -> bool:
        sized.evaluate("tell('/shots', {robot: 0})")
        return is_red(between)

    until(shines, 10, "the beam of robot 0 is seen on its way to robot 1")
    hit = {"number": 1, "kind": 0, "name": NAMES[1], "by": "Al", "life": 66, "streak": 0, "revenge": False}
    sized.evaluate("message => take(message, 'Al')", status(hit))
    width = sized.viewport_size["width"] if sized.viewport_size else 0
    sized.screenshot(path=screenshots / f"arena-{width}.png")
    until(lambda: not is_red(between), 10, "the shot is over")
    back = [PLACES[2][0] - 0.075, PLACES[2][1]]  # of robot 2, where a dash of its rim would be

    def light(*covered: int) -> int:
        sized.evaluate("robots => tell('/overhead/covered', {robots})", covered)
        sized.evaluate("message => tell('/positions', message)", positions(*PLACES))
        return int(sum(sized.evaluate(COLOUR, back)))

    dark = light()
    until(lambda: light(2) > dark + 150, 10, "robot 2 is covered, and has a rim")
    sized.screenshot(path=screenshots / f"arena-covered-{width}.png")
    until(lambda: light() < dark + 30, 10, "it is seen again")

    def around(effects: int, distance: float) -> list[int]:
        sized.evaluate("message => take(message, 'Al')", status(hit, effects=effects))
        sized.evaluate("message => tell('/positions', message)", positions(*PLACES))
        return list(sized.evaluate(COLOUR, [PLACES[2][0] - distance, PLACES[2][1]]))

    until(lambda: around(1, SHIELD)[2] > 150, 10, "its shield is a blue ring")
    until(lambda: around(2, RAYS)[0] > 150 > around(2, SHIELD)[2], 10, "double damage is red rays beyond it")
    sized.screenshot(path=screenshots / f"arena-effects-{width}.png")
    until(lambda: max(around(0, RAYS)) < 150, 10, "it has nothing any more")


def test_positions_that_stop_are_missed_and_come_back(chromium: Browser, game_page: GamePage) -> None:
    with chromium.new_page() as page:
        page.clock.install()
        page.goto(game_page.url)
        page.wait_for_function("() => Boolean(window.take)")
        arena = page.locator("#arena")
        page.clock.run_for(3000)
        assert page.evaluate("heard") == ["none"]
        expect(arena).to_be_hidden()
        page.evaluate("message => tell('/positions', message)", positions())
        expect(arena).to_contain_text("nobody")
        expect(arena.locator("p")).to_be_visible()
        page.clock.run_for(4000)
        assert page.evaluate("heard") == ["none", "live", "lost"]
        expect(arena).to_be_visible()  # with its last state, dimmed
        page.evaluate("message => tell('/positions', message)", positions((0.5, 0.5)))
        assert page.evaluate("heard") == ["none", "live", "lost", "live"]
        expect(arena.locator("p")).to_be_hidden()


def test_the_simulators_own_page_draws_the_same(chromium: Browser, screenshots: Path) -> None:
    arena = Arena()
    try:
        with ExitStack() as stack, chromium.new_page(viewport={"width": 800, "height": 600}) as page:
            complaints: list[str] = []
            page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
            page.on("pageerror", lambda error: complaints.append(str(error)))
            for number in range(2):
                stack.enter_context(Hardware(arena, f"virtual{number}"))
            until(lambda: len(arena.look()) == 2, 10, "both are there")
            page.goto(arena.page)
            robot = arena.look()["virtual0"]
            rim = [robot["x"] - RIM * math.cos(robot["heading"]), robot["y"] - RIM * math.sin(robot["heading"])]
            until(lambda: sum(page.evaluate(COLOUR, rim)) > 250, 10, "a robot's rim shines")
            page.screenshot(path=screenshots / "arena_page.png")
            assert complaints == []
    finally:
        arena.program.stop()
