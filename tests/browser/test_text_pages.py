"""The pages to read, in a real browser: for everybody, on each screen, in each language, by day and by night."""

import re
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
import requests
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import looks, violations
from tests.integration.server.conftest import GameServer, ros_master
from tests.support.polling import until
from tests.support.ros import RosMaster

__all__ = ["ros_master"]

PATHS = {
    "about": "/about",
    "404": "/nothing",
    "desk-closed": "/operator",
    "results": "/results",
    "battle": "/results/1",
    "leaderboard": "/results/leaderboard",
    "results-404": "/results/99",
}


@pytest.fixture(scope="module")
def server(ros_master: RosMaster, tmp_path_factory: pytest.TempPathFactory) -> Iterator[GameServer]:
    """Al and Bo have played two battles there, seen from above."""
    folder = tmp_path_factory.mktemp("data")
    server = GameServer(ros_master, folder, (), LASERBOT_COUNTDOWN="1", LASERBOT_HIT_DAMAGE="40")
    server.wait_until_serving()
    play(server)
    yield server
    server.end()


def play(server: GameServer) -> None:
    server.peer("positions")
    robots = [server.robot(f"robot{number}") for number in range(2)]
    pages = [server.player(name) for name in ("Al", "Bo")]
    listener = server.listener()
    for _ in range(2):
        for page in pages:
            page.ready()
        listener.wait_for(lambda status: status["game"] == 2)
        listener.wait_for(lambda status: status["time_left"] <= 298)
        for life in (60, 20, 0):
            robots[1].hit()
            listener.wait_for_life("Bo", life)
        listener.wait_for(lambda status: status["game"] == 0)
    for page in pages:
        page.close()
    with requests.Session() as http:
        until(lambda: http.get(f"{server.url}/results.json").json()["battles"][0]["seconds"] is not None, 5)


@pytest.fixture
def page(chromium: Browser) -> Iterator[Page]:
    """Of somebody in Rome, whose browser prefers Italian."""
    context = chromium.new_context(locale="it-IT", timezone_id="Europe/Rome")
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    yield page
    context.close()
    assert complaints == []


def test_everybody_can_use_them(server: GameServer, page: Page, screenshots: Path) -> None:
    found: dict[str, list[str]] = {}
    for name, path in PATHS.items():
        page.goto(f"{server.url}{path}")
        if name == "battle":
            expect(page.locator("#replay-floor p").first).to_be_visible()
        for look in looks(page):
            page.screenshot(path=screenshots / f"{name}-{look}.png", full_page=True)
            found[f"{name} {look}"] = violations(page)
            if page.evaluate("document.documentElement.scrollWidth > innerWidth"):
                found[f"{name} {look}"].append("sticks out")
    assert {where: what for where, what in found.items() if what} == {}


def test_language_and_colours_are_chosen_by_keyboard_and_kept(server: GameServer, page: Page) -> None:
    page.goto(f"{server.url}/about")
    root, heading = page.locator("html"), page.locator("h1")
    expect(root).to_have_attribute("lang", "it")
    expect(heading).to_contain_text("Vince l'ultimo che resta.")
    expect(page).to_have_title("Il gioco | LaserBot Battle")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    expect(page.locator("#language")).to_be_focused()
    with page.expect_navigation():
        page.keyboard.press("ArrowDown")
    expect(root).to_have_attribute("lang", "de")
    expect(heading).to_contain_text("Wer zuletzt lebt, gewinnt.")
    page.get_by_role("button", name="Sprache und Farben").press("Enter")
    page.get_by_role("combobox", name="Farben").select_option("hell")
    expect(root).to_have_css("color-scheme", "light")
    page.goto(f"{server.url}/results")
    expect(root).to_have_attribute("data-theme", "light")
    expect(heading).to_have_text("Kämpfe")
    page.goto(f"{server.url}/nothing")
    expect(root).to_have_attribute("data-theme", "light")
    expect(page.locator("main")).to_contain_text("Diese Seite gibt es nicht.")


def test_moments_are_told_in_the_readers_time_zone_and_language(server: GameServer, page: Page) -> None:
    began = page.request.get(f"{server.url}/results/1.json").json()["began"]
    rome = datetime.fromtimestamp(began, ZoneInfo("Europe/Rome"))
    page.goto(f"{server.url}/results/1")
    expect(page.locator(".about-battle time")).to_have_text(re.compile(rf" {rome.day} .*{rome:%H:%M}$"))
    expect(page.locator("#notice")).to_have_text("Battaglia finita: Bo è stato abbattuto.")
    expect(page.locator("#notice")).not_to_have_attribute("lang", "en")
    page.goto(f"{server.url}/results")
    expect(page.locator(".battle time").last).to_have_text(f"{rome:%H:%M}")  # the first battle is the last there
    day = page.locator(".day time").first
    weekday, date = day.inner_text().split(maxsplit=1)
    assert weekday.startswith(("lun", "mar", "mer", "gio", "ven", "sab", "dom"))
    assert date.split()[0] == str(int((day.get_attribute("datetime") or "")[-2:])), "the same day in each time zone"


def test_without_scripts_moments_are_told_in_utc(server: GameServer, chromium: Browser) -> None:
    context = chromium.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{server.url}/results/1")
    moment = page.locator(".about-battle time")
    utc = (moment.get_attribute("datetime") or "").replace("T", " ")[:16]
    expect(moment).to_have_text(f"{utc} UTC")
    expect(page.locator("#notice")).to_have_text("Battle over: Bo was shot down.")
    context.close()
