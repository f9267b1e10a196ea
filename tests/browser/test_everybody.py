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
    with Battle(robots=2, LASERBOT_COUNTDOWN="20", LASERBOT_HIT_DAMAGE="100", LASERBOT_TEAMS="2") as running:
        yield running


class Looks:
    """What axe-core has against the states of the pages that it was shown."""

    def __init__(self) -> None:
        self.found: dict[str, list[str]] = {}

    def all(self, page: Page, state: str) -> None:
        self.found.update({f"{state}, {size}": violations(page) for size in looks(page)})

    def once(self, page: Page, state: str) -> None:
        """At what goes by too fast for every size."""
        self.found[state] = violations(page)


@pytest.mark.timeout(900)  # its own deadlines are for a busy machine
def test_nobody_is_left_out_on_the_way_in_in_a_battle_and_after_it(battle: Battle, chromium: Browser) -> None:
    look = Looks()
    ann, cem = Person(chromium, battle, "Ann"), Person(chromium, battle, "Cem")
    come_in(ann, look)
    with Player(battle, "Bob") as bob:
        cem.page.locator("#username").fill("Cem")
        cem.page.locator("#username").press("Enter")
        expect(cem.page.locator("#queue-title")).to_be_visible()
        look.all(cem.page, "queue")
        cem.page.goto(f"{battle.web}/watch")
        expect(cem.page.locator("body")).to_contain_text("Ann")
        look.all(cem.page, "watch, before a battle")
        fight(battle, (ann, bob, cem.page), look)
    ann.page.goto(battle.web)
    expect(ann.page.locator("#restore-title")).to_be_visible()
    look.all(ann.page, "still signed in")
    for person in (ann, cem):
        person.context.close()
    assert {state: lines for state, lines in look.found.items() if lines} == {}


def come_in(ann: Person, look: Looks) -> None:
    look.all(ann.page, "login")
    ann.page.locator("#how-to").click()
    look.all(ann.page, "help")
    ann.page.keyboard.press("Escape")
    ann.page.locator("#username").fill("no spaces")
    ann.page.locator("#username").press("Enter")
    expect(ann.page.locator("dialog[open]")).to_be_visible()
    look.all(ann.page, "a bad name")
    ann.page.keyboard.press("Escape")
    ann.log_in()
    expect(ann.page.locator("#seats")).to_contain_text("Ann")
    look.all(ann.page, "lobby")
    for button, state in (("#settings", "settings"), ("#sign-out", "sign out?")):
        ann.page.locator(".user-button").click()
        look.once(ann.page, f"the player's card before {state}")
        ann.page.locator(button).click()
        expect(ann.page.locator("dialog[open]")).to_be_visible()
        look.all(ann.page, state)
        ann.page.keyboard.press("Escape")


def fight(battle: Battle, people: tuple[Person, Player, Page], look: Looks) -> None:
    ann, bob, watch = people
    ann.page.locator("#ready-btn").click()
    assert bob.ready() == "OK"
    expect(ann.page.locator("#countdown")).to_be_visible()
    look.all(ann.page, "countdown")
    look.once(watch, "watch, countdown")
    expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
    look.all(ann.page, "battle")
    look.all(watch, "watch, battle")
    shoot(battle, bob, ann, "dialog[open]")
    look.all(ann.page, "result")
    look.once(watch, "watch, podium")
    ann.page.keyboard.press("Escape")
    look.all(ann.page, "after the battle")


def shoot(battle: Battle, hunter: Player, prey: Person, sign: str) -> None:
    """Until the prey's page has the `sign` of it, a selector."""
    with Eyes(battle) as eyes:
        mind = Hunter(eyes.floor)

        def is_shot() -> bool:
            hunter.drive(*mind.command(eyes.robots(), hunter.robot, prey.robot))
            return prey.page.locator(sign).count() > 0

        until(is_shot, 120, f"{hunter.name} shoots {prey.name}")


@pytest.mark.timeout(900)
def test_nobody_is_left_out_who_is_out_or_waits_or_tries_a_robot(chromium: Browser) -> None:
    look = Looks()
    with (
        Battle(
            3, LASERBOT_COUNTDOWN="5", LASERBOT_HIT_DAMAGE="100", LASERBOT_PRACTICE="1", LASERBOT_OFFER="600"
        ) as battle,
        Player(battle, "Bob") as bob,
        Player(battle, "Dan") as dan,
    ):
        ann = Person(chromium, battle, "Ann")
        ann.log_in()
        look.all(ann.page, "practice")
        ann.page.locator("#ready-btn").click()
        expect(ann.page.locator("#ready-btn")).to_have_attribute("aria-pressed", "true")
        assert (bob.ready(), dan.ready()) == ("OK", "OK")
        expect(ann.page.locator("body")).to_have_attribute("data-phase", "playing")
        shoot(battle, bob, ann, "[data-phase=out]")
        look.all(ann.page, "out")
        cem = Person(chromium, battle, "Cem")
        cem.page.locator("#username").fill("Cem")
        cem.page.locator("#username").press("Enter")
        expect(cem.page.locator("#queue-title")).to_be_visible()
        dan.post("signOutUser", data="Dan")
        expect(cem.page.locator("#take")).to_be_visible()
        look.all(cem.page, "an offer")
        for person in (ann, cem):
            person.context.close()
    assert {state: lines for state, lines in look.found.items() if lines} == {}
