"""Who comes while a battle runs drives beside it, and joins it; who keeps losing is spared: in real browsers."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.browser.axe import violations
from tests.browser.people import Person
from tests.browser.ros_node import node
from tests.support.battle import Battle
from tests.support.play import start
from tests.support.player import Eyes, Player
from tests.support.polling import until

pytestmark = pytest.mark.slow  # three robots; the other pages' demo has two


@pytest.fixture(scope="module")
def battle() -> Iterator[Battle]:
    rules = {"COUNTDOWN": 2, "PROTECTION": 0, "HIT_DAMAGE": 100, "HANDICAP": 40, "LATE_JOIN": 1, "PRACTICE_BESIDE": 1}
    settings: dict[str, Any] = {f"LASERBOT_{name}": str(value) for name, value in rules.items()}
    with Battle(3, **settings) as battle:
        yield battle


def test_a_late_comer_drives_beside_the_battle_then_joins_it_and_is_spared_after_losing(
    battle: Battle, person: Callable[..., Person], screenshots: Path
) -> None:
    cy = person("Cy")
    text, hint, button = (cy.page.locator(f"#{one}") for one in ("game-status", "game-hint", "ready-btn"))
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        start(ann, bob)
        cy.log_in()
        expect(button).to_have_text("Join in")
        expect(hint).to_have_text(re.compile("^You can still join"))
        before = eyes.robots()[cy.robot]["heading"]
        cy.hold((0, 1, False))
        until(lambda: eyes.robots()[cy.robot]["heading"] != before, 20, "Cy's robot turns beside the battle")
        cy.hold((0, 0, False))
        assert violations(cy.page) == []
        cy.page.screenshot(path=screenshots / "late-comer.png")
        button.click()
        expect(text).to_have_text("PLAY!")
        expect(button).to_be_hidden()
        taken_out = (f"shot:{ann.robot}", f"hit:{cy.robot}:{ann.robot}")
        with node(battle, "light", *taken_out, f"shot:{ann.robot}", f"hit:{bob.robot}:{ann.robot}"):
            expect(cy.page.locator("dialog[open]")).to_contain_text("Ann")
        for _ in range(2):
            cy.page.get_by_role("button", name="Rematch").click()
            assert ann.ready() == "OK"
            expect(text).to_have_text("PLAY!")
            with node(battle, "light", *taken_out):
                expect(cy.page.locator("dialog[open]")).to_contain_text("Ann")
        cy.page.get_by_role("button", name="Rematch").click()
        assert ann.ready() == "OK"
        expect(hint).to_have_text("You lost three battles in a row: now hits take 40% less from you.")
        expect(text).to_have_text("PLAY!")
        with node(battle, "light", *taken_out):
            expect(cy.page.locator("#announcer")).to_have_text("Hit by Ann! Life 40 percent.")
