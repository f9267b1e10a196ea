"""Teams, and light that tells who has shot, in real browsers: the robots' reports come from a ROS node of the tests."""

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import violations
from tests.browser.people import Person
from tests.browser.ros_node import node
from tests.support.battle import Battle
from tests.support.demo import Demo
from tests.support.player import Player


@pytest.fixture
def people(person: Callable[..., Person]) -> tuple[Person, Person]:
    """Ann on robot 0 and Bob on robot 1."""
    here = person("Ann"), person("Bob")
    for robot, one in enumerate(here):
        one.log_in()
        assert one.robot == robot
    return here


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=2, hit_damage=50)
    return demo


def play(*people: Person) -> None:
    for person in people:
        person.page.locator("#ready-btn").click()
    for person in people:
        expect(person.page.locator("#game-status")).to_have_text("PLAY!")


NOTE = """selector => {
  const look = () => {
    const text = document.querySelector(`${selector}:not([hidden])`)?.textContent;
    if (text) (window.noted ??= {})[selector] ??= text;
  };
  const all = { subtree: true, childList: true, characterData: true, attributes: true };
  new MutationObserver(look).observe(document.body, all);
}"""


class Noted:
    """The text of what will be shown for a moment only: the page itself looks, since a busy machine may be too late."""

    def __init__(self, page: Page, selector: str) -> None:
        self._page, self._selector = page, selector
        page.evaluate(NOTE, selector)

    def text(self) -> str:
        noted = self._page.wait_for_function("selector => window.noted?.[selector]", arg=self._selector)
        return " ".join(str(noted.json_value()).split())


def test_shooter_and_victim_see_whose_hit_it_was(
    battle: Demo, people: tuple[Person, Person], screenshots: Path
) -> None:
    ann, bob = people
    play(ann, bob)
    mark, note, kill = (
        Noted(ann.page, "#hit-mark"),
        Noted(bob.page, "#hit-note"),
        Noted(ann.page, "#hit-mark[data-kind=kill]"),
    )
    with node(battle, "light", "shot:0", "hit:1:0"):
        assert mark.text() == "+1Bob"
        ann.page.screenshot(path=screenshots / "hit.png")
        assert note.text() == "Hit by Ann!"
        for person in (ann, bob):
            entry = person.page.locator("#feed li").first
            expect(entry).to_have_text("Ann hits Bob: 50%")
            expect(entry.locator("img:visible")).to_have_count(2)
        expect(ann.page.locator("#announcer")).to_have_text("You hit Bob: 50 percent left.")
        expect(bob.page.locator("#announcer")).to_have_text("Hit by Ann! Life 50 percent.")
    with node(battle, "light", "hit:1:0", "shot:0", "shot:0", "hit:1:0"):  # the first is nobody's: no shot is under way
        assert kill.text() == "+1Bob is out!"
    expect(ann.page.locator("#feed")).to_contain_text("Ann takes Bob out!")
    result = ann.page.locator("dialog[open]")
    for text in ("YOU WIN!", "3 shots fired", "2 of them hit", "accuracy 67%", "1 robot taken out"):
        expect(result).to_contain_text(text)
    expect(bob.page.locator("dialog[open]")).to_contain_text("0 shots fired")
    assert violations(ann.page) == []


def test_who_drives_a_weak_robot_is_told(battle: Demo, people: tuple[Person, Person]) -> None:
    ann, bob = people
    expect(ann.page.locator("#own-weak")).to_be_hidden()
    with node(battle, "board", str(ann.robot), "4200"):
        expect(ann.page.locator("#own-weak")).to_have_text("Battery low: tell the operator")
        expect(ann.page.locator("#own-weak")).to_be_visible()
        assert violations(ann.page) == []
        expect(bob.page.locator("#own-weak")).to_be_hidden()


@pytest.mark.slow
def test_teams_are_chosen_fight_and_win(chromium: Browser, screenshots: Path) -> None:
    with Battle(robots=3, LASERBOT_COUNTDOWN="15", LASERBOT_HIT_DAMAGE="50", LASERBOT_TEAMS="2") as battle:
        ann, bob = Person(chromium, battle, "Ann"), Person(chromium, battle, "Bob")
        ann.log_in()
        bob.log_in()
        with Player(battle, "Dora") as dora:
            watch = chromium.new_page()
            watch.goto(f"{battle.web}/watch")
            ann.page.locator(".team-button[data-team='1']").click()
            bob.page.locator(".team-button[data-team='2']").focus()
            bob.page.keyboard.press("Enter")
            for person, team in ((ann, "1"), (bob, "2")):
                expect(person.page.locator(".team-button[aria-pressed=true]")).to_have_attribute("data-team", team)
            expect(ann.page.locator(".seat[data-name=Bob]")).to_contain_text("Blue")
            expect(watch.locator("[data-name=Bob]")).to_contain_text("Blue")
            ann.page.screenshot(path=screenshots / "teams-lobby.png")
            assert violations(ann.page) == []
            assert dora.ready() == "OK"  # she leaves her team to the referee
            play(ann, bob)
            expect(ann.page.locator("#own-team")).to_have_text("Red")
            expect(ann.page.locator("#game-hint")).to_contain_text("You fight for team Red")
            expect(bob.page.locator("#own-team")).to_have_text("Blue")
            expect(ann.page.locator(".rival").first).to_contain_text("Dora")
            expect(ann.page.locator(".rival").first).to_contain_text("Red")
            expect(ann.page.locator(".rival.is-first")).to_contain_text("Blue")
            expect(watch.locator("#headline")).to_have_text("2 teams are still standing")
            ann.page.screenshot(path=screenshots / "teams.png")
            assert violations(ann.page) == []
            with node(battle, "light", "shot:0", "hit:1:0", "shot:0", "hit:1:0"):
                expect(watch.locator("#feed li").first).to_have_text("Team Red wins!")
            expect(watch.locator("[data-metal=gold]")).to_contain_text("Dora")
            expect(ann.page.locator("dialog[open]")).to_contain_text("YOU WIN!")
            told = "Team Red wins! Your team, Blue, came in at number 2."
            expect(bob.page.locator("dialog[open]")).to_contain_text(told)
            assert violations(bob.page) == []
            watch.close()
            for one in (ann, bob):
                one.context.close()
                assert one.complaints == []
