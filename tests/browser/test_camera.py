"""The robots' cameras on the pages, in a real browser on the whole chain: a camera's stream, the relay, the page."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.browser.people import Person
from tests.support.battle import Battle
from tests.support.picture_source import PictureSource, tell

GREEN, RED = "#208040", "#a02020"
# The colour at a place of the picture on the screen, which covers its box and is cut on two sides; places are 0 to 1.
PIXEL = """([selector, x, y]) => {
  const canvas = document.querySelector(selector);
  const box = canvas.getBoundingClientRect();
  const scale = Math.max(box.width / canvas.width, box.height / canvas.height);
  const column = canvas.width / 2 + ((x - 0.5) * box.width) / scale;
  const row = canvas.height / 2 + ((y - 0.5) * box.height) / scale;
  const [red, green, blue] = canvas.getContext("2d").getImageData(column, row, 1, 1).data;
  return [red, green, blue];
}"""


@pytest.fixture(scope="module")
def battle() -> Iterator[Battle]:
    with Battle(robots=2, LASERBOT_COUNTDOWN="2") as running:
        yield running


@pytest.fixture
def camera(battle: Battle) -> Iterator[PictureSource]:
    """Of both robots."""
    with PictureSource(GREEN) as source:
        for robot in (0, 1):
            tell(battle.ports["LASERBOT_ROS_PORT"], robot, source.url)
        yield source


def is_coloured(page: Page, colour: str, selector: str = "#camera") -> bool:
    """Whether that is what the floor looks like, right of the middle of the picture."""
    seen = page.evaluate(PIXEL, [selector, 0.53, 0.5])
    wanted = [int(colour[start : start + 2], 16) for start in (1, 3, 5)]
    return all(abs(one - other) < 12 for one, other in zip(seen, wanted, strict=True))


def test_a_player_sees_what_the_robot_sees(person: Callable[[str], Person], camera: PictureSource) -> None:
    ann = person("Ann")
    ann.log_in()
    expect(ann.page.locator("#stage")).to_have_attribute("data-view", "eyes")
    expect(ann.page.locator("#camera")).to_be_visible()
    assert is_coloured(ann.page, GREEN)
    assert camera.viewers == 1
