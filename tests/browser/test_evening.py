"""A whole evening for three people with one seat too few, each in a browser of a language of their own."""

import re
from collections.abc import Callable

import pytest
from PIL import Image, ImageColor
from playwright.sync_api import Download, expect

from tests.browser.people import Person
from tests.support.demo import Demo
from tests.support.programs import ROOT


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=3, battle_limit=2)  # s, long enough for a busy browser to be seen counting
    return demo


@pytest.fixture
def people(person: Callable[..., Person]) -> list[Person]:
    languages = {"Ann": "en-GB", "Bea": "it-IT", "Cem": "de-DE"}
    return [person(name, locale=locale) for name, locale in languages.items()]


def test_queue_accept_battle_result_rematch_and_give_away(people: list[Person]) -> None:
    ann, bea, cem = people
    for person, language in zip(people, ("en", "it", "de"), strict=True):
        expect(person.page.locator("html")).to_have_attribute("lang", language)
    ann.log_in()
    bea.log_in()
    cem.page.locator("#username").fill("Cem")
    cem.page.locator("#username").press("Enter")
    expect(cem.page.locator("#queue-title")).to_have_text("Du bist als Nächstes dran.")
    expect(ann.page.locator("#waiting")).to_have_text("1 person is waiting for a robot.")
    expect(bea.page.locator("#seats")).to_contain_text("Ann")

    for person in (ann, bea):
        person.page.locator("#ready-btn").click()
    expect(bea.page.locator("#countdown")).to_be_visible()
    expect(bea.page.locator("#game-status")).to_have_text("VIA!")
    expect(ann.page.locator("#clock")).to_be_visible()
    expect(ann.page.locator("#ready-btn")).to_be_hidden()

    for person, title in ((ann, "DRAW!"), (bea, "PAREGGIO!")):
        expect(person.page.locator("dialog[open] h2")).to_have_text(title)
    expect(ann.page.locator("dialog[open] .podium")).to_contain_text("Bea")
    with ann.page.expect_download() as saved:
        ann.page.get_by_role("button", name="Save as a picture").click()
    shows_the_result(saved.value, ann.robot)
    bea.page.get_by_role("button", name="Rivincita").click()
    expect(bea.page.locator("#ready-btn")).to_have_attribute("aria-pressed", "true")
    ann.page.get_by_role("button", name="Give my seat away").click()
    ann.page.wait_for_url("**/watch")

    expect(cem.page.locator("#take")).to_be_focused()
    cem.page.keyboard.press("Enter")
    cem.page.wait_for_url("**/home")
    expect(cem.page.locator(".robotN").first).to_have_text(f"Roboter {ann.robot}")
    cem.page.locator("#ready-btn").click()
    for person, title in ((cem, "UNENTSCHIEDEN!"), (bea, "PAREGGIO!")):
        expect(person.page.locator("dialog[open] h2")).to_have_text(title)
    expect(cem.page.locator(".own-stats")).to_contain_text("0 Treffer kassiert")
    cem.page.keyboard.press("Escape")
    expect(cem.page.locator("#lobby")).to_be_visible()


def shows_the_result(saved: Download, robot: int) -> None:
    """A picture with the robot's colour at its edge, and something written in the middle."""
    assert re.fullmatch(r"laserbot-battle-\d+\.png", saved.suggested_filename)
    with Image.open(saved.path()) as picture:
        assert (picture.format, picture.size) == ("PNG", (1200, 630))
        pixels = picture.convert("RGB")
    of_robots = re.findall("#[0-9a-f]{6}", (ROOT / "server/static/js/arena/colours.js").read_text())
    assert pixels.getpixel((5, 300)) == ImageColor.getrgb(of_robots[robot])
    written = pixels.crop((310, 150, 1130, 300)).getcolors(1 << 16)
    assert written is not None
    assert len(written) > 20


def test_the_language_and_the_colours_are_chosen_on_any_page_and_kept(people: list[Person]) -> None:
    ann = people[0]
    ann.page.locator("button[popovertarget=preferences]").click()
    ann.page.locator("#language").select_option("de")
    expect(ann.page.locator("#username")).to_have_attribute("placeholder", "dein Name")
    ann.page.locator("button[popovertarget=preferences]").click()
    ann.page.locator("#theme").select_option("light")
    expect(ann.page.locator("html")).to_have_attribute("data-theme", "light")
    ann.page.reload()
    expect(ann.page.locator("html")).to_have_attribute("data-theme", "light")
    ann.log_in()
    expect(ann.page.locator("#game-status")).to_have_text("Drück auf Bereit, um zu starten!")
