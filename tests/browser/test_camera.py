"""The robots' cameras on the pages, in a real browser on the whole chain: a camera's stream, the relay, the page."""

import json
import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, Page, WebSocket, expect

from tests.browser.axe import Looks, violations
from tests.browser.people import Person
from tests.support.demo import TOKEN, Demo, Demos
from tests.support.picture_source import PictureSource, tell
from tests.support.player import Player
from tests.support.polling import until

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


# A cookie goes to one host name: a WebSocket to another name of this machine is without it.
NO_COOKIE = """
window.WebSocket = class extends WebSocket {
  constructor(url, ...more) { super(url.replace("127.0.0.1", "localhost"), ...more); }
};
"""
HIDE = """(hidden) => {
  Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
  document.dispatchEvent(new Event("visibilitychange"));
}"""


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=2, hide_cameras=True)
    return demo


@pytest.fixture(scope="module")
def source(demos: Demos) -> Iterator[PictureSource]:
    """One camera for all tests: a relay that still follows that of the test before would look elsewhere."""
    with PictureSource(GREEN) as source:
        yield source
    if demos.running:
        for robot in (0, 1):
            eyes = f"http://127.0.0.1:{demos.running.arena_port}/eyes/virtual{robot}"
            tell(demos.running.ports["LASERBOT_ROS_PORT"], robot, eyes)


@pytest.fixture
def camera(battle: Demo, source: PictureSource) -> PictureSource:
    """Of both robots, with nothing wrong."""
    source.is_frozen, source.is_online, source.clock = False, True, 0.0
    source.paint(GREEN)
    for robot in (0, 1):
        tell(battle.ports["LASERBOT_ROS_PORT"], robot, source.url)
    return source


@pytest.fixture
def ann(person: Callable[..., Person], camera: PictureSource) -> Person:
    """She sees through her robot's camera."""
    ann = person("Ann", camera=True, arena=True)
    ann.log_in()
    expect(ann.page.locator("#camera")).to_be_visible()
    return ann


def wait_for_colour(page: Page, colour: str) -> None:
    """Until that is what the floor looks like, right of the middle of the picture."""
    wanted = [int(colour[start : start + 2], 16) for start in (1, 3, 5)]

    def is_coloured() -> bool:
        seen = page.evaluate(PIXEL, ["#camera", 0.53, 0.5])
        return all(abs(one - other) < 12 for one, other in zip(seen, wanted, strict=True))

    until(is_coloured, 5, "a picture of that colour")


def test_a_player_sees_what_the_robot_sees(ann: Person, camera: PictureSource) -> None:
    page = ann.page
    expect(page.locator("#stage")).to_have_attribute("data-view", "camera")
    expect(page.locator("#camera")).to_have_attribute("data-level", "fresh")
    expect(page.locator("#camera-note")).to_be_hidden()
    wait_for_colour(page, GREEN)
    camera.paint(RED)
    wait_for_colour(page, RED)
    until(lambda: camera.streams == 1, 5, "that is all that is fetched")


def test_a_key_a_button_and_the_arena_in_the_corner_choose_the_view_which_is_remembered(
    ann: Person, camera: PictureSource
) -> None:
    page, stage = ann.page, ann.page.locator("#stage")
    arena = page.locator("#arena canvas")
    expect(arena).to_be_visible()
    page.locator("#to-arena").click()
    expect(stage).to_have_attribute("data-view", "arena")
    expect(page.locator("#camera")).to_be_hidden()
    expect(page.locator("#to-arena")).to_be_hidden()
    expect(arena).to_be_visible()
    until(lambda: camera.streams == 0, 5, "nothing is fetched that nobody sees")
    page.reload()
    expect(page.locator("#view")).to_be_visible()
    expect(stage).to_have_attribute("data-view", "arena")
    page.keyboard.press("v")
    expect(page.locator("#camera")).to_be_visible()
    page.locator("#view").focus()
    page.keyboard.press("Enter")
    expect(stage).to_have_attribute("data-view", "arena")
    page.keyboard.press("Enter")
    expect(stage).to_have_attribute("data-view", "camera")
    page.reload()
    expect(stage).to_have_attribute("data-view", "camera")
    page.locator("#how-to").click()
    page.keyboard.press("v")  # belongs to the dialog
    expect(stage).to_have_attribute("data-view", "camera")


def test_a_picture_that_stands_still_is_grey_with_its_age_and_comes_back(ann: Person, camera: PictureSource) -> None:
    page = ann.page
    camera.is_frozen = True
    expect(page.locator("#camera")).to_have_attribute("data-level", "stale")
    expect(page.locator("#camera-age")).to_have_text(re.compile(r"^\d+ s old$"))
    expect(page.locator("#camera-note")).to_have_text("The camera's picture is frozen.")
    expect(page.locator("#camera-note")).to_have_text("The camera does not answer. The page keeps trying.")
    camera.is_frozen = False
    expect(page.locator("#camera")).to_have_attribute("data-level", "fresh")
    expect(page.locator("#camera-note")).to_be_hidden()


@pytest.mark.slow
def test_a_late_picture_tells_its_age(ann: Person, camera: PictureSource) -> None:
    camera.clock = -0.6
    expect(ann.page.locator("#camera-age")).to_have_text(re.compile(r"^0\.[67] s old$"))
    assert ann.page.locator("#camera").get_attribute("data-level") == "late"


@pytest.mark.slow
def test_a_camera_that_is_unplugged_is_told(ann: Person, camera: PictureSource) -> None:
    camera.is_online = False
    expect(ann.page.locator("#camera-note")).to_have_text("The robot's camera is missing: is it plugged in?")
    expect(ann.page.locator("#camera")).to_have_attribute("data-level", "stale")
    camera.is_online = True
    expect(ann.page.locator("#camera-note")).to_be_hidden()


@pytest.mark.slow
def test_the_picture_comes_back_after_the_relay(ann: Person, battle: Demo) -> None:
    battle.kill(r"python3 -m server\.camera")
    expect(ann.page.locator("#camera")).to_have_attribute("data-level", "stale")
    expect(ann.page.locator("#camera-note")).to_have_text("The camera's picture is frozen.")
    expect(ann.page.locator("#camera")).to_have_attribute("data-level", "fresh")


def test_without_a_camera_the_stage_shows_the_arena(person: Callable[..., Person], battle: Demo) -> None:
    bea = person("Bea", camera=True, arena=True)
    heard: list[str] = []

    def is_told() -> bool:
        for robot in (0, 1):
            tell(battle.ports["LASERBOT_ROS_PORT"], robot, None)
        if any('"live"' in text for text in heard):  # a robot has registered again meanwhile, and told of its own eyes
            heard.clear()
            battle.kill(r"python3 -m server\.camera")
        bea.page.title()  # Playwright tells of frames only while it is asked something
        return any('"none"' in text for text in heard)

    is_told()
    bea.page.on("websocket", lambda socket: socket.on("framereceived", lambda text: heard.append(str(text))))
    bea.log_in()
    until(is_told, 20, "the relay says so")
    expect(bea.page.locator("#arena canvas")).to_be_visible()
    expect(bea.page.locator("#stage")).to_have_attribute("data-view", "arena")
    expect(bea.page.locator("#view")).to_be_hidden()
    bea.page.keyboard.press("v")
    expect(bea.page.locator("#stage")).to_have_attribute("data-view", "arena")


def test_a_hidden_page_looks_through_no_camera(person: Callable[..., Person], camera: PictureSource) -> None:
    cem = person("Cem", camera=True)
    wishes: list[object] = []

    def note(text: str | bytes) -> None:
        message = json.loads(text)
        if message["op"] == "watch":
            wishes.append(message["robot"])

    def listen(socket: WebSocket) -> None:
        if str(cem.battle.relay_port) in socket.url:
            socket.on("framesent", note)

    cem.page.on("websocket", listen)
    cem.log_in()
    expect(cem.page.locator("#camera")).to_be_visible()
    cem.page.evaluate(HIDE, True)
    until(lambda: camera.streams == 0, 5, "the relay has left the camera")
    cem.page.evaluate(HIDE, False)
    expect(cem.page.locator("#camera")).to_have_attribute("data-level", "fresh")
    assert wishes == [cem.robot, None, cem.robot]


@pytest.mark.slow
def test_without_the_cookie_the_ticket_tells_whose_camera_it_is(
    person: Callable[..., Person], camera: PictureSource
) -> None:
    eve = person("Eve", policy=False, camera=True)
    eve.context.add_init_script(NO_COOKIE)
    eve.log_in()
    expect(eve.page.locator("#camera")).to_be_visible()
    with Player(eve.battle, "Bob") as bob:
        eve.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(eve.page.locator("#game-status")).to_contain_text("PLAY!")
        camera.paint(RED)  # spectators see nothing of a battle here, and so would she
        wait_for_colour(eve.page, RED)


@pytest.mark.parametrize(("width", "height"), [(390, 844), pytest.param(844, 390, marks=pytest.mark.slow)])
def test_on_a_phone_the_picture_has_the_screen_and_a_tap_leads_to_the_arena(
    chromium: Browser, battle: Demo, camera: PictureSource, width: int, height: int
) -> None:
    viewport = {"width": width, "height": height}
    context = chromium.new_context(viewport=viewport, has_touch=True, is_mobile=True)  # type: ignore[arg-type]
    page = context.new_page()
    page.goto(battle.web)
    page.locator("#username").fill("Fay")
    page.locator("#username").press("Enter")
    page.wait_for_url("**/home")
    expect(page.locator("#camera")).to_be_visible()
    with Player(battle, "Bob") as bob:
        page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(page.locator("#game-status")).to_contain_text("PLAY!")
        picture, aim = page.locator("#camera").bounding_box(), page.locator(".aim").bounding_box()
        assert picture is not None
        assert aim is not None
        assert picture["width"] == width
        assert height > width or picture["height"] >= 0.6 * height
        assert aim["x"] + aim["width"] / 2 == pytest.approx(picture["x"] + picture["width"] / 2, abs=1)
        assert aim["y"] + aim["height"] / 2 == pytest.approx(picture["y"] + picture["height"] / 2, abs=1)
        page.locator("#to-arena").tap()
        expect(page.locator("#stage")).to_have_attribute("data-view", "arena")
        page.locator("#view").tap()
        expect(page.locator("#camera")).to_be_visible()
    context.request.post(f"{battle.web}/signOutUser", form={"data": "Fay"})
    context.close()


def test_a_spectator_chooses_a_camera_by_the_keyboard_until_a_battle_hides_it(
    chromium: Browser, battle: Demo, camera: PictureSource
) -> None:
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.goto(f"{battle.web}/watch")
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob:
        choice = page.locator("#view-choice")
        expect(choice.locator("option")).to_have_text(
            ["the arena", *(f"camera of {one.name} (robot {one.robot})" for one in sorted((ann, bob), key=robot_of))]
        )
        choice.focus()
        page.keyboard.press("ArrowDown")
        expect(page.locator("#camera")).to_be_visible()
        expect(page.locator("#arena")).to_be_hidden()
        expect(page).to_have_url(re.compile("#robot0$"))
        page.reload()
        expect(page.locator("#camera")).to_be_visible()
        wait_for_colour(page, GREEN)
        assert (ann.ready(), bob.ready()) == ("OK", "OK")
        expect(page.locator("#camera-note")).to_have_text("The cameras are hidden while a battle runs.")
        expect(page.locator("#camera")).to_be_hidden()
        choice.select_option(label="the arena")
        expect(page.locator("#arena")).to_be_visible()
        expect(page).to_have_url(re.compile("/watch$"))
    page.close()


def robot_of(player: Player) -> int:
    return player.robot


def test_operators_look_through_any_camera_and_see_what_all_of_them_cost(
    chromium: Browser, battle: Demo, camera: PictureSource
) -> None:
    desk = chromium.new_page()
    desk.goto(f"{battle.web}/operator")
    desk.get_by_label("Operator token").fill(TOKEN)
    desk.get_by_role("button", name="Sign in").click()
    look = desk.locator("#robots-rows [data-key='1']").get_by_role("button", name="Camera")
    look.focus()
    desk.keyboard.press("Enter")
    expect(desk.locator("#camera")).to_be_visible()
    wait_for_colour(desk, GREEN)
    row = desk.locator("#cameras-rows [data-key='1']")
    expect(row.locator("[data-field=state]")).to_have_text("live")
    expect(row.locator("[data-field=rate]")).to_have_text(re.compile(r"^(1\d|20)(\.\d)?/s$"))
    expect(desk.locator("#cameras-viewers")).to_have_text(re.compile(r"^\d of 200$"))
    expect(desk.locator("#cameras-rate")).to_have_text(re.compile(r"^[1-9][\d.]* of 200$"))
    assert violations(desk) == []
    desk.keyboard.press("Escape")
    expect(desk.locator("#camera-panel")).to_be_hidden()
    expect(look).to_be_focused()
    expect(desk.locator("#cameras-rows tr")).to_have_count(0)
    desk.close()


def test_nobody_is_left_out_by_the_cameras(ann: Person, camera: PictureSource, look: Looks) -> None:
    look.all(ann.page, "fresh")
    camera.is_frozen = True
    expect(ann.page.locator("#camera-note")).to_be_visible()
    look.all(ann.page, "stale")
    ann.page.goto(f"{ann.battle.web}/watch#robot{ann.robot}")
    expect(ann.page.locator("#view-choice option")).to_have_count(2)
    look.all(ann.page, "watch")
