"""The game's pages for everybody: axe-core has nothing against any state of them, dark or light, large or small."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import Looks
from tests.browser.people import Person
from tests.support.battle import Battle
from tests.support.demo import Demo
from tests.support.play import hunt_down
from tests.support.player import Eyes, Player


@pytest.fixture
def battle(demo: Demo, look: Looks) -> Demo:
    demo.play_by(countdown=20 if look.thorough else 8, hit_damage=100, teams=2)
    return demo


def test_nobody_is_left_out_on_the_way_in_in_a_battle_and_after_it(
    battle: Demo, person: Callable[..., Person], look: Looks
) -> None:
    ann, cem = person("Ann", arena=True), person("Cem")
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


def come_in(ann: Person, look: Looks) -> None:
    look.all(ann.page, "login")
    ann.page.locator("#how-to").click()
    look.all(ann.page, "help")
    ann.page.keyboard.press("Escape")
    ann.page.locator("#username").fill("Ann!")
    expect(ann.page.locator("#username")).to_have_attribute("aria-invalid", "true")
    look.all(ann.page, "a bad name")
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


def fight(battle: Demo, people: tuple[Person, Player, Page], look: Looks) -> None:
    ann, bob, watch = people
    ann.page.locator("#ready-btn").click()
    assert bob.ready() == "OK"
    expect(ann.page.locator("#countdown")).to_be_visible()
    look.all(ann.page, "countdown")
    look.once(watch, "watch, countdown")
    expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
    look.all(ann.page, "battle")
    look.all(watch, "watch, battle")
    with Eyes(battle) as eyes:
        hunt_down(bob, ann, eyes, life=0)
    expect(ann.page.locator("dialog[open]")).to_be_visible()
    look.all(ann.page, "result")
    look.once(watch, "watch, podium")
    ann.page.keyboard.press("Escape")
    look.all(ann.page, "after the battle")


@pytest.mark.slow
def test_nobody_is_left_out_who_is_out_or_waits_or_tries_a_robot(chromium: Browser, look: Looks) -> None:
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
        with Eyes(battle) as eyes:
            hunt_down(bob, ann, eyes, life=0)
        expect(ann.page.locator("[data-phase=out]")).to_be_visible()
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
