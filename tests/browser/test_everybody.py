"""The game's pages for everybody: axe-core has nothing against any state of them, dark or light, large or small."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import looks, violations
from tests.browser.people import Person
from tests.support.battle import Battle
from tests.support.player import Eyes, Hunter, Player
from tests.support.polling import until


@pytest.fixture
def battle() -> Iterator[Battle]:
    with Battle(robots=2, LASERBOT_COUNTDOWN="20", LASERBOT_HIT_DAMAGE="100") as running:
        yield running


@pytest.mark.timeout(900)  # its own deadlines are for a busy machine
def test_every_state_of_login_game_and_watch(battle: Battle, chromium: Browser) -> None:
    found: dict[str, list[str]] = {}
    ann, cem = Person(chromium, battle, "Ann"), Person(chromium, battle, "Cem")

    def look(page: Page, state: str) -> None:
        found.update({f"{state}, {size}": violations(page) for size in looks(page)})

    def look_once(page: Page, state: str) -> None:
        """At what goes by too fast for every size."""
        found[state] = violations(page)

    look(ann.page, "login")
    ann.page.locator("#how-to").click()
    look(ann.page, "help")
    ann.page.keyboard.press("Escape")
    ann.page.locator("#username").fill("no spaces")
    ann.page.keyboard.press("Enter")
    look(ann.page, "a bad name")
    ann.page.keyboard.press("Escape")
    ann.log_in()
    expect(ann.page.locator("#seats")).to_contain_text("Ann")
    look(ann.page, "lobby")
    for button, state in (("#settings", "settings"), ("#sign-out", "sign out?")):
        ann.page.locator(".user-button").click()
        look(ann.page, "the player's card")
        ann.page.locator(button).click()
        look(ann.page, state)
        ann.page.keyboard.press("Escape")
    with Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        cem.page.locator("#username").fill("Cem")
        cem.page.locator("#username").press("Enter")
        expect(cem.page.locator("#queue-title")).to_be_visible()
        look(cem.page, "queue")
        cem.page.goto(f"{battle.web}/watch")
        expect(cem.page.locator("body")).to_contain_text("Ann")
        look(cem.page, "watch, before a battle")
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(ann.page.locator("#countdown")).to_be_visible()
        look(ann.page, "countdown")
        look_once(cem.page, "watch, countdown")
        expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
        look(ann.page, "battle")
        look(cem.page, "watch, battle")
        hunter = Hunter(eyes.floor)

        def ann_is_shot() -> bool:
            bob.drive(*hunter.command(eyes.robots(), bob.robot, ann.robot))
            return ann.page.locator("dialog[open]").count() > 0

        until(ann_is_shot, 120, "Bob shoots Ann")
        look(ann.page, "result")
        look_once(cem.page, "watch, podium")
        ann.page.keyboard.press("Escape")
        look(ann.page, "after the battle")
        ann.page.goto(battle.web)
        expect(ann.page.locator("#restore-title")).to_be_visible()
        look(ann.page, "still signed in")
    for person in (ann, cem):
        person.context.close()
    assert {state: lines for state, lines in found.items() if lines} == {}
