"""A tournament in real browsers: led on the desk; players and the hall see when and where they play."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import Looks
from tests.support.demo import TOKEN, Demo


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=2)
    return demo


@pytest.fixture
def hall(chromium: Browser, battle: Demo) -> Page:
    page = chromium.new_page()
    page.goto(f"{battle.web}/watch")
    return page


@pytest.fixture
def bracket(chromium: Browser, battle: Demo) -> Page:
    page = chromium.new_page()
    page.goto(f"{battle.web}/tournament")
    return page


@pytest.fixture
def desk(chromium: Browser, battle: Demo) -> Page:
    page = chromium.new_page(viewport={"width": 1280, "height": 800})
    page.request.post(f"{battle.web}/operator/login", form={"token": TOKEN, "name": "Otto"})
    page.goto(f"{battle.web}/operator")
    return page


def test_a_tournament_from_the_desk_to_its_winner(
    desk: Page, hall: Page, bracket: Page, person, *, look: Looks, screenshots: Path
) -> None:
    ann = person("Ann")
    ann.log_in()
    panel = desk.locator("section#tournament")
    panel.get_by_text("Open a tournament").click()
    expect(desk.locator("#players-rows")).to_contain_text("Ann")
    panel.get_by_role("button", name="Enter who is here").click()
    names = panel.get_by_label("Players, one per line")
    expect(names).to_have_value("Ann")
    names.fill("Ann\nBob\nCy\nDee")
    look.all(desk, "desk, opening a tournament")
    panel.get_by_role("button", name="Open", exact=True).click()
    expect(panel.locator("#tournament-rows tr")).to_have_count(3)
    card = ann.page.locator("#tournament")
    expect(card).to_have_text(re.compile(r"^Match 1: you play against Dee in about \w+ minute"))
    panel.get_by_role("button", name="Call match 1").click()
    expect(card).to_have_text(f"Match 1: you play against Dee now, with robot {ann.robot}. Press Ready!")
    expect(hall.locator(".hall-tournament li").first).to_contain_text(f"now: Ann with robot {ann.robot}, Dee with")
    expect(bracket.locator(".is-called")).to_contain_text("Dee")
    bob = person("Bob", phone=(844, 390))
    bob.page.locator("#username").fill("Bob")
    bob.page.locator("#username").press("Enter")
    expect(bob.page.locator("#queue-tournament")).to_have_text(re.compile("^Match 2: you play against Cy in about"))
    for page, name in ((bob.page, "queue"), (ann.page, "player"), (hall, "hall"), (bracket, "bracket"), (desk, "desk")):
        for how in look.at(page):
            page.screenshot(path=screenshots / f"tournament-{name}-{how}.png", full_page=name in ("desk", "bracket"))
        look.all(page, f"{name} with a match that is called")
    for number, answer in ((1, "Dee is not there"), (2, "Bob is not there")):
        panel.get_by_role("button", name=f"Decide of match {number}").click()
        look.once(desk, f"deciding match {number}")
        desk.get_by_role("button", name=answer).click()
    expect(card).to_have_text(re.compile("^Match 3: you play against Cy"))
    panel.get_by_role("button", name="Decide of match 3").click()
    desk.get_by_role("button", name="Ann wins").click()
    expect(desk.locator("#problem-text")).to_have_text("Say why: the reason is logged.")
    panel.get_by_role("button", name="Decide of match 3").click()
    desk.get_by_label("Reason").fill("the power has failed")
    desk.get_by_role("button", name="Ann wins").click()
    expect(panel.locator("#tournament-state")).to_have_text("Ann has won the tournament!")
    expect(hall.locator(".hall-tournament")).to_contain_text("Ann has won the tournament!")
    expect(bracket.locator(".tournament-champion")).to_be_visible()
    expect(desk.locator("#log-rows")).to_contain_text("Ann has won, since: the power has failed (by Otto)")
    panel.get_by_role("button", name="Close the tournament").click()
    desk.locator("dialog").get_by_role("button", name="Close the tournament").click()
    expect(card).to_be_hidden()
    expect(hall.locator(".hall-tournament")).to_have_count(0)
    expect(bracket.locator(".tournament-champion")).to_be_visible()
