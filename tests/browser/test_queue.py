"""Those who wait for a robot are called when one is theirs, also where nobody looks at the page."""

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from tests.browser.people import Person
from tests.support.demo import Demo
from tests.support.player import Player

# somebody who looks elsewhere, at a browser that shows its notices in `window.notices`
LOOKS_AWAY = """
document.hasFocus = () => false;
window.notices = [];
window.Notification = class extends EventTarget {
  static permission = "default";
  static async requestPermission() { return (this.permission = "granted"); }
  constructor(title) { super(); this.title = title; window.notices.push(this); }
  close() { window.notices = window.notices.filter((one) => one !== this); }
};
"""


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=1)
    return demo


def test_an_offer_calls_who_has_asked_until_it_is_answered(person: Callable[..., Person], battle: Demo) -> None:
    ann = person("Ann")
    page = ann.page
    page.add_init_script(LOOKS_AWAY)
    page.reload()
    title = page.title()
    with Player(battle, "One") as one, Player(battle, "Two"):
        page.locator("#username").fill("Ann")
        page.locator("#username").press("Enter")
        page.locator("#tell").click()
        expect(page.locator("#told")).to_be_visible()
        expect(page.locator("#tell")).to_be_hidden()
        one.post("signOutUser", data="One")
        expect(page.locator("#take")).to_be_visible()
        expect(page.locator("#told")).to_be_hidden()
        assert f"Robot {one.robot} is yours!" in page.title()
        assert page.evaluate("notices.map(({ title }) => title)") == [f"Robot {one.robot} is yours!"]
        page.locator("#leave").click()
        expect(page.locator("#queue")).to_be_hidden()
        assert page.title() == title
        assert page.evaluate("notices") == []
