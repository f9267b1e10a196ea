"""The arena's picture in a real browser: inside a page of the game, on another port, and by itself."""

import json
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import CHROMIUM, FLAGS
from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.demo import Demo
from tests.support.player import Player
from tests.support.polling import until
from tests.support.programs import ROOT

PAGE = """<!doctype html>
<link rel="icon" href="/img/favicon.svg">
<style>body { margin: 0 } iframe { border: 0; width: 100vw; height: 100vh } [hidden] { display: none }</style>
<iframe title="arena"></iframe>
<script type="module">
  import { ArenaView } from "./js/common/arena_view.js";
  const heard = [];
  const [frame, url] = [document.querySelector("iframe"), new URLSearchParams(location.search).get("arena")];
  window.view = new ArenaView({ frame, url, onState: (state) => heard.push(state) });
  window.heard = heard;
</script>"""
NAMES = ("Al", "Bea_the_Great_16", "Zoe", "Bob")


class GamePages(ThreadingHTTPServer):
    """A port with a page that shows the arena, the page's own scripts and avatars; remembers what was asked for."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        super().__init__((HOST, 0), partial(_Handler, directory=str(ROOT / "server" / "static")))

    def url(self, arena: Arena, host: str = HOST, arena_host: str = HOST) -> str:
        return f"http://{host}:{self.server_port}/?arena=http://{arena_host}:{arena.view_port}"


class _Handler(SimpleHTTPRequestHandler):
    server: GamePages

    def do_GET(self) -> None:
        self.server.asked.append(self.path)
        if not self.path.startswith("/?"):
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(PAGE.encode())

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - as the base class calls it
        pass


@pytest.fixture
def pages() -> Iterator[GamePages]:
    with GamePages() as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


@pytest.fixture
def arena() -> Iterator[Arena]:
    arena = Arena()
    yield arena
    arena.program.stop()


@pytest.fixture
def robots(arena: Arena) -> Iterator[list[Hardware]]:
    with ExitStack() as stack:
        yield [stack.enter_context(Hardware(arena, f"virtual{number}")) for number in range(6)]


def players(**fields: Any) -> dict[str, Any]:
    """Four players on the robots 0 to 3; the last one is out."""
    each = [
        {"name": name, "robot": robot, "life": 100 - 30 * robot, "ready": True, "out": robot == 3}
        for robot, name in enumerate(NAMES)
    ]
    for player in each:
        player["avatar"] = f"/img/avatar{player['robot']}.svg"
    return {"me": "Al", "phase": "playing", "labels": {"you": "TU"}, "players": each, **fields}


def picture(page: Page) -> str:
    """What the picture says about itself to those who do not see it."""
    return page.frame_locator("iframe").locator("#floor").get_attribute("aria-label") or ""


def becomes(page: Page, state: str) -> None:
    page.wait_for_function("state => window.view?.state === state", arg=state, timeout=30_000)


@pytest.fixture(
    params=[
        (1280, 720),
        pytest.param((844, 390), marks=pytest.mark.slow),
        pytest.param((390, 844), marks=pytest.mark.slow),
    ],
    ids=["desktop", "landscape", "portrait"],
)
def sized(request: pytest.FixtureRequest, chromium: Browser) -> Iterator[Page]:
    width, height = request.param
    with chromium.new_page(viewport={"width": width, "height": height}) as page:
        yield page


def test_inside_a_page_the_picture_has_the_names_and_lives_it_is_told(
    sized: Page, arena: Arena, robots: list[Hardware], pages: GamePages, screenshots: Path
) -> None:
    robots[1].send("beam 1")
    page = sized
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(pages.url(arena))
    becomes(page, "live")
    page.evaluate("fields => view.show(fields)", players())
    until(lambda: "Al 100 %" in picture(page), 10, "the names are there")
    until(lambda: page.evaluate("view.report.fps") > 0, 10, "it draws")
    told = "Al 100 %, Bea_the_Great_16 70 %, Zoe 40 %, Bob out, Robot 4, Robot 5"
    assert picture(page) == f"The arena seen from above, {told}"
    until(lambda: {f"/img/avatar{number}.svg" for number in range(4)} <= set(pages.asked), 10, "its avatars come")
    assert page.evaluate("[view.report.type, view.report.state]") == ["laserbot-arena", "live"]
    assert page.frame_locator("iframe").locator("aside").is_hidden()
    width = page.viewport_size["width"] if page.viewport_size else 0
    page.screenshot(path=screenshots / f"arena-in-a-page-{width}.png")
    assert complaints == []


@pytest.mark.slow
@pytest.mark.usefixtures("robots")
def test_it_works_under_the_masters_name_in_which_policies_do_not_take_the_underscore(
    chromium: Browser, arena: Arena, pages: GamePages
) -> None:
    name = "laser_bot_master.local"
    flags = [*FLAGS, f"--host-resolver-rules=MAP {name} {HOST}"]
    browser = chromium.browser_type.launch(executable_path=CHROMIUM, headless=True, args=flags)
    try:
        page = browser.new_page()
        page.goto(pages.url(arena, name, name))
        becomes(page, "live")
        page.evaluate("fields => view.show(fields)", players())
        until(lambda: "Al 100 %" in picture(page), 10, "the names are there")
    finally:
        browser.close()


def test_a_picture_of_another_site_is_not_asked_for(chromium: Browser, arena: Arena, pages: GamePages) -> None:
    asked: list[str] = []
    with Hardware(arena, "virtual0"), chromium.new_page() as page:
        page.on("request", lambda request: asked.append(request.url))
        page.goto(pages.url(arena))
        becomes(page, "live")
        strange = {**players()["players"][0], "avatar": "http://192.0.2.1/spy.png"}
        page.evaluate("fields => view.show(fields)", players(players=[strange]))
        until(lambda: "Al 100 %" in picture(page), 10, "the name is there")
        assert not [url for url in asked if "192.0.2.1" in url]


def test_a_page_of_another_host_can_neither_show_the_arena_nor_speak_to_it(
    chromium: Browser, arena: Arena, pages: GamePages
) -> None:
    with chromium.new_page() as page:
        refusals: list[str] = []
        page.on("console", lambda message: refusals.append(message.text))
        page.goto(pages.url(arena, host="localhost"))
        until(lambda: any("frame-ancestors" in text for text in refusals), 10, "the browser refuses")
        becomes(page, "unreachable")
        assert page.locator("iframe").is_hidden()


@pytest.mark.slow
def test_an_arena_that_goes_and_comes_back_is_told_and_no_error_page_is_seen(
    chromium: Browser, arena: Arena, pages: GamePages
) -> None:
    arena.program.stop()
    with chromium.new_page() as page:
        page.goto(pages.url(arena))
        frame = page.locator("iframe")
        expect(frame).to_be_hidden()
        becomes(page, "unreachable")
        expect(frame).to_be_hidden()
        arena.start()
        page.evaluate("fields => view.show(fields)", players())
        becomes(page, "live")
        expect(frame).to_be_visible()
        with Hardware(arena, "virtual0"):
            until(lambda: "Al 100 %" in picture(page), 10, "the new picture knows the players")
        arena.program.stop()
        becomes(page, "lost")
        expect(frame).to_be_visible()  # with its last state, dimmed
        arena.start()
        becomes(page, "live")
        assert json.loads(page.evaluate("JSON.stringify(heard.filter((state) => state !== 'connecting'))")) == [
            "unreachable", "live", "lost", "live",
        ]  # fmt: skip


def test_by_itself_it_hears_from_rosbridge_who_plays(demo: Demo, chromium: Browser, screenshots: Path) -> None:
    with Player(demo, "Ann") as ann, chromium.new_context(locale="de-DE") as context:
        page = context.new_page()
        page.goto(demo.view.replace("ws://", "http://").removesuffix("/view"))
        row = page.locator("#robots li").nth(ann.robot)
        expect(row).to_contain_text("Ann")
        expect(row).to_contain_text("nicht bereit")
        expect(page.locator("#robots li").nth(1 - ann.robot)).to_contain_text(f"Roboter {1 - ann.robot}")
        assert ann.ready() == "OK"
        expect(row).to_contain_text("100 %")
        assert "virtual" not in page.locator("body").inner_text()
        page.screenshot(path=screenshots / "arena_page.png")
