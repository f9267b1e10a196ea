"""The driving page on a phone, upright and on its side, and what it shows somebody new."""

import itertools
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import FloatRect, Locator, Page, expect

from tests.browser.axe import violations
from tests.browser.people import Person
from tests.support.demo import Demo
from tests.support.player import Player

UPRIGHT, ON_ITS_SIDE = (390, 844), (844, 390)
CONTROLS = (".thumb-pad", ".thumb-fire")


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(practice=True, countdown=1)
    return demo


def box(shown: Locator) -> FloatRect:
    expect(shown).to_be_visible()
    found = shown.bounding_box()
    assert found is not None
    return found


def overlap(one: FloatRect, other: FloatRect) -> bool:
    def meet(side: str, length: str) -> bool:
        start, end = max(one[side], other[side]), min(one[side] + one[length], other[side] + other[length])  # type: ignore[literal-required]
        return float(end - start) > 1  # less is rounding

    return meet("x", "width") and meet("y", "height")


def in_each_others_way(page: Page, *selectors: str) -> list[tuple[str, str]]:
    boxes = {selector: box(page.locator(selector)) for selector in selectors}
    return [pair for pair in itertools.combinations(selectors, 2) if overlap(boxes[pair[0]], boxes[pair[1]])]


def test_somebody_new_is_shown_the_first_steps_once(person: Callable[..., Person], screenshots: Path) -> None:
    ann = person("Ann")
    ann.log_in()
    hint = ann.page.locator(".guide-text")
    for command, told in (((1, 0, False), "to drive"), ((0, 1, False), "to turn"), ((0, 0, True), "to shoot")):
        expect(hint).to_contain_text(told)
        ann.page.screenshot(path=screenshots / f"guide-{told[3:]}.png")
        if told == "to drive":
            assert violations(ann.page) == []
        ann.hold(command)
    expect(ann.page.locator("#guide")).to_be_hidden()
    ann.hold((0, 0, False))
    ann.page.reload()
    expect(ann.page.locator("body.is-driving")).to_be_visible()
    expect(ann.page.locator("#guide")).to_be_hidden()


@pytest.mark.parametrize("screen", [UPRIGHT, ON_ITS_SIDE], ids=["upright", "on its side"])
def test_on_a_phone_the_first_steps_leave_picture_and_controls_free(
    person: Callable[..., Person], screenshots: Path, screen: tuple[int, int]
) -> None:
    ann = person("Ann", arena=True, phone=screen)
    ann.log_in()
    floor = ann.page.locator("#arena canvas")
    guide = box(ann.page.locator("#guide"))
    expect(ann.page.locator(".guide-text")).to_contain_text("the pad")
    ann.page.screenshot(path=screenshots / f"guide-{screen[0]}.png")
    for beside in (guide, box(ann.page.locator("#lobby"))):
        assert not overlap(beside, box(floor))
    assert in_each_others_way(ann.page, "#guide", ".own", ".tools", "#lobby", *CONTROLS) == []
    ann.page.locator(".guide-skip").tap()
    expect(ann.page.locator("#guide")).to_be_hidden()
    ann.page.reload()
    expect(ann.page.locator("body.is-driving")).to_be_visible()
    expect(ann.page.locator("#guide")).to_be_hidden()


def test_upright_nothing_lies_on_the_picture_of_a_battle(
    battle: Demo, person: Callable[..., Person], screenshots: Path
) -> None:
    ann = person("Ann", phone=UPRIGHT)
    ann.log_in()
    with Player(battle, "José_longname 16") as bob:
        ann.page.locator("#ready-btn").tap()
        assert bob.ready() == "OK"
        expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
        ann.page.screenshot(path=screenshots / "battle-390.png")
        around = (".own", ".tools", "#clock", ".picture", ".rivals", ".feed-box", *CONTROLS)
        assert in_each_others_way(ann.page, "#lobby", *around) == []
        name = ann.page.locator("#feed bdi[title='José_longname 16']").first
        assert box(name)["height"] < 30, "it is cut, not broken"
        ann.page.locator("#hit-note").evaluate("note => { note.lastChild.textContent = 'Hit!'; note.hidden = false; }")
        assert in_each_others_way(ann.page, "#hit-note", *around) == []
        ann.context.set_offline(True)
        expect(ann.page.locator("#banner")).to_be_visible()
        ann.page.screenshot(path=screenshots / "offline-390.png")
        assert in_each_others_way(ann.page, ".life-value", "#connection-state", "#banner") == []
        ann.context.set_offline(False)
        expect(ann.page.locator("#banner")).to_be_hidden()
        bob.post("signOutUser", data=bob.name)
        result = ann.page.locator("dialog[open]")
        expect(result.locator(".podium-rest strong")).to_have_attribute("title", bob.name)
        assert result.evaluate("dialog => dialog.scrollWidth <= dialog.clientWidth")
