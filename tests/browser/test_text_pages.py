"""The pages to read, in a real browser: for everybody, on each screen, in each language, by day and by night."""

import re
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import Looks, violations
from tests.browser.played import Played

PATHS = {
    "about": "/about",
    "404": "/nothing",
    "desk-closed": "/operator",
    "results": "/results",
    "battle": "/results/2",
    "leaderboard": "/results/leaderboard",
    "tournament": "/tournament",
    "results-404": "/results/99",
}


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


def test_everybody_can_use_them(played: Played, page: Page, screenshots: Path, look: Looks) -> None:
    for name, path in PATHS.items():
        page.goto(f"{played.url}{path}")
        if name == "battle":
            expect(page.locator("#replay-floor canvas")).to_have_attribute("aria-label", re.compile("Jörg"))
        for how in look.at(page):
            page.screenshot(path=screenshots / f"{name}-{how}.png", full_page=True)
            look.found[f"{name} {how}"] = violations(page)
            if page.evaluate("document.documentElement.scrollWidth > innerWidth"):
                look.found[f"{name} {how}"].append("sticks out")


def test_language_and_colours_are_chosen_by_keyboard_and_kept(played: Played, page: Page) -> None:
    page.goto(f"{played.url}/about")
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
    page.goto(f"{played.url}/results")
    expect(root).to_have_attribute("data-theme", "light")
    expect(heading).to_have_text("Kämpfe")
    page.goto(f"{played.url}/nothing")
    expect(root).to_have_attribute("data-theme", "light")
    expect(page.locator("main")).to_contain_text("Diese Seite gibt es nicht.")


def test_moments_are_told_in_the_readers_time_zone_and_language(played: Played, page: Page) -> None:
    began = page.request.get(f"{played.url}/results/2.json").json()["began"]
    rome = datetime.fromtimestamp(began, ZoneInfo("Europe/Rome"))
    page.goto(f"{played.url}/results/2")
    expect(page.locator(".about-battle time")).to_have_text(re.compile(rf" {rome.day} .*{rome:%H:%M}$"))
    expect(page.locator("#notice")).to_have_text("Battaglia finita: Bob è stato abbattuto.")
    expect(page.locator("#notice")).not_to_have_attribute("lang", "en")
    page.goto(f"{played.url}/results")
    expect(page.locator(".battle time").first).to_have_text(f"{rome:%H:%M}")  # the last battle is the first there
    day = page.locator(".day time").first
    weekday, date = day.inner_text().split(maxsplit=1)
    assert weekday.startswith(("lun", "mar", "mer", "gio", "ven", "sab", "dom"))
    assert date.split()[0] == str(int((day.get_attribute("datetime") or "")[-2:])), "the same day in each time zone"


def test_without_scripts_moments_are_told_in_utc(played: Played, chromium: Browser) -> None:
    context = chromium.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{played.url}/results/2")
    moment = page.locator(".about-battle time")
    utc = (moment.get_attribute("datetime") or "").replace("T", " ")[:16]
    expect(moment).to_have_text(f"{utc} UTC")
    expect(page.locator("#notice")).to_have_text("Battle over: Bob was shot down.")
    context.close()
