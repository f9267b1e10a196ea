"""What the camera above the floor sees, under the robots that pages draw, on the whole chain: a camera's stream, the
tracker, the relay, the page."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import requests
from playwright.sync_api import Browser, Page, expect

from laser_bot_battle.floor import read_floor
from sim.arena.overhead.conditions import Conditions
from tests.browser.axe import Looks
from tests.browser.people import Person
from tests.support.demo import TOKEN, Demo
from tests.support.fake_camera import FakeCamera, part_of
from tests.support.polling import LATEST, until
from tests.support.programs import Program

FLOOR = "duel"  # the demo's
# How red the picture is at a place of the floor, in m: 0 to 255. The drawn floor is nearly black, the real one grey.
RED = """([drawing, margin, x, y, width]) => {
  const canvas = document.querySelector(`${drawing} canvas`);
  const scale = canvas.width / (width + 2 * margin);
  return canvas.getContext("2d").getImageData((x + margin) * scale, canvas.height - (y + margin) * scale, 1, 1).data[0];
}"""


@pytest.fixture
def battle(demo: Demo) -> Demo:
    return demo


@pytest.fixture
def above(battle: Demo) -> FakeCamera:
    """A camera above the floor that sees all as it is now; nobody drives here."""
    camera = FakeCamera(rate=15)
    snapshot = requests.get(f"http://127.0.0.1:{battle.arena_port}/overhead/snapshot", timeout=LATEST).content
    camera.part = lambda each, _: part_of(each, snapshot)
    return camera


@pytest.fixture
def tracker(battle: Demo, above: FakeCamera) -> Iterator[FakeCamera]:
    """Looks through that camera."""
    with above:
        program = Program.python(
            "server.overhead",
            env={
                "ROS_MASTER_URI": f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}",
                "LASERBOT_OVERHEAD_CAMERA": above.url,
                "LASERBOT_OVERHEAD_HEIGHT": f"{Conditions().height:g}",
                "LASERBOT_FLOOR": FLOOR,
            },
        )
        try:
            program.wait_for("the floor is known by")
            yield above
        finally:
            program.stop()


def is_real(page: Page, drawing: str = "#arena", margin: float = 0.05) -> bool:
    """Whether the camera's picture is in the drawing, which has a margin of so many m around the floor."""
    floor = read_floor(FLOOR)
    seen: int = page.evaluate(RED, [drawing, margin, floor.width * 0.53, floor.height * 0.22, floor.width])
    return seen > 50


def test_a_player_lays_the_real_floor_under_the_robots_until_its_camera_is_away(
    person: Callable[..., Person], tracker: FakeCamera, look: Looks, screenshots: Path
) -> None:
    ann = person("Ann", camera=True, arena=True)
    sockets: list[str] = []
    ann.page.on("websocket", lambda socket: sockets.append(socket.url))
    ann.log_in()
    page, switch, note = ann.page, ann.page.locator("#real-floor"), ann.page.locator("#real-floor-note")
    expect(switch).to_have_attribute("aria-pressed", "false")
    expect(switch).to_be_visible()
    expect(switch).to_have_accessible_name("The real floor under the robots")
    assert not is_real(page)
    assert tracker.streams == 1  # the tracker's: nobody looks
    relays = [url for url in sockets if str(ann.battle.relay_port) in url]
    assert len(relays) == 1  # that of the robot's camera
    switch.focus()
    page.keyboard.press("Enter")
    expect(switch).to_have_attribute("aria-pressed", "true")
    until(lambda: is_real(page), 10, "the real floor")
    assert tracker.streams == 2
    page.screenshot(path=screenshots / "real-floor.png")
    look.all(page, "real floor")
    page.reload()
    until(lambda: is_real(page), 10, "the real floor, as the browser remembers")
    tracker.stop()
    expect(note).to_have_text("No picture from above")
    expect(note).to_be_visible()
    until(lambda: not is_real(page), 10, "the drawn floor")
    look.all(page, "away")
    tracker.start()
    expect(note).to_be_hidden()
    until(lambda: is_real(page), 10, "the real floor again")
    page.locator("#real-floor").click()
    until(lambda: not is_real(page) and tracker.streams == 1, 10, "nothing is fetched any more")
    expect(note).to_be_hidden()


def test_spectators_have_the_switch_too_and_nothing_is_fetched_for_an_arena_that_nobody_sees(
    chromium: Browser, battle: Demo, tracker: FakeCamera, look: Looks, screenshots: Path
) -> None:
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    sockets: list[str] = []
    page.on("websocket", lambda socket: sockets.append(socket.url))
    page.goto(f"{battle.web}/watch")
    expect(page.locator("#real-floor")).to_be_visible()
    assert not [url for url in sockets if str(battle.relay_port) in url]
    page.locator("#real-floor").click()
    until(lambda: is_real(page), 10, "the real floor")
    page.screenshot(path=screenshots / "real-floor-watch.png")
    look.all(page, "watch")
    page.goto(f"{battle.web}/watch#robot0")
    page.reload()
    expect(page.locator("#camera")).to_be_visible()
    until(lambda: tracker.streams == 1, 10, "nobody looks from above")
    page.close()


def test_without_a_camera_above_the_floor_there_is_no_switch(person: Callable[..., Person]) -> None:
    bea = person("Bea", arena=True)
    bea.log_in()
    expect(bea.page.locator("#arena canvas")).to_be_visible()
    expect(bea.page.locator("#real-floor")).to_be_hidden()


def test_the_editor_of_the_floor_lies_over_it(
    chromium: Browser, battle: Demo, tracker: FakeCamera, look: Looks, screenshots: Path
) -> None:
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    page.request.post(f"{battle.web}/operator/login", form={"token": TOKEN, "name": "Otto"})
    page.goto(f"{battle.web}/operator")
    page.get_by_text("Change the floor").click()
    page.get_by_role("button", name="The real floor").click()
    until(lambda: is_real(page, "#floor-picture", 0.25), 10, "the real floor under the drawing")
    page.locator("#floor-editor").screenshot(path=screenshots / "real-floor-editor.png")
    look.all(page, "the floor's editor, over the real floor")
    page.get_by_role("button", name="The real floor").click()
    until(lambda: not is_real(page, "#floor-picture", 0.25) and tracker.streams == 1, 10, "the drawn floor")

    troubles = page.locator("#overhead-troubles")
    expect(troubles).to_be_hidden()
    tracker.stop()
    expect(troubles).to_contain_text("no picture of the camera above the floor")
    look.all(page, "the desk, without its camera above the floor")
    page.close()
