"""Two people play a battle to its end, each in a browser: keys to coils, light to life, all through the firmware."""

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.people import Person
from tests.support.demo import Demo
from tests.support.player import Eyes, Hunter
from tests.support.polling import until


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(hit_damage=25, countdown=3)
    return demo


@pytest.fixture
def people(person: Callable[..., Person]) -> tuple[Person, Person]:
    """Ann sees the arena from above."""
    return person("Ann", arena=True), person("Bob")


def test_two_people_play_to_the_end(
    battle: Demo, people: tuple[Person, Person], chromium: Browser, screenshots: Path
) -> None:
    ann, bob = people
    ann.log_in()
    bob.log_in()
    expect(ann.page.locator("#userList")).to_contain_text("Bob")
    expect(bob.page.locator("#userList")).to_contain_text("Ann")
    for person in people:
        person.page.locator("#ready-btn").click()
    for person in people:
        expect(person.page.locator("#game-status")).to_contain_text("sec to start")
    for person in people:
        expect(person.page.locator("#game-status")).to_contain_text("PLAY!")

    arena = ann.page.locator("#arena canvas")
    expect(arena).to_be_visible()

    above = chromium.new_page(viewport={"width": 1280, "height": 800})
    above.goto(f"http://127.0.0.1:{battle.arena_port}/")
    with Eyes(battle) as eyes:
        start = eyes.robots()[bob.robot]

        def bob_moved() -> bool:
            bob.hold((1, 1, False))
            now = eyes.robots()[bob.robot]
            return (now["x"], now["y"]) != (start["x"], start["y"])

        until(bob_moved, 10, "Bob's keys move Bob's robot")
        bob.hold((0, 0, False))

        ann_life, bob_life = (person.page.locator("#userLife .life-value") for person in people)

        hunter = Hunter(eyes.floor)

        def bob_is_hurt() -> bool:
            linear, angular, shoot = hunter.command(eyes.robots(), ann.robot, bob.robot)
            ann.hold((linear, angular, shoot))
            ann.hold((linear, angular, False))  # a tap is one pulse: few are fired between two looks, late as they are
            return "100" not in bob_life.inner_text()

        until(bob_is_hurt, 120, "Ann hits Bob")
        ann.hold((0, 0, False))
        others = ann.page.locator("#userList")
        until(lambda: bob_life.inner_text().removeprefix("LIFE ") in others.inner_text(), 20, "Ann sees Bob's life")
        assert "100" in ann_life.inner_text()
        ann.page.screenshot(path=screenshots / "home.png")
        above.screenshot(path=screenshots / "arena.png")

        def over() -> bool:
            ann.hold(hunter.command(eyes.robots(), ann.robot, bob.robot))
            return "YOU WIN!" in ann.page.locator("body").inner_text()

        until(over, 120, "Ann wins")
    ann.hold((0, 0, False))
    expect(bob.page.locator("body")).to_contain_text("YOU LOST!")
    expect(ann.page.locator("dialog[open]")).to_contain_text("Ann")
    expect(ann.page.locator("dialog[open]")).to_contain_text("Bob")
    ann.page.screenshot(path=screenshots / "result.png")
    above.close()
