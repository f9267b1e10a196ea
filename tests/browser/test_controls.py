"""Thumbs, gamepads, sounds and the screen in a real browser, on a page that has only them."""

import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, CDPSession, Page, Route, expect

from tests.browser.conftest import FLAGS
from tests.support.polling import until
from tests.support.programs import ROOT

FOLDER = ROOT / "tests" / "browser" / "controls"
HOME = "http://localhost/"  # every request is answered by the test: nothing goes out
PHONE = {"width": 844, "height": 390}
POLICY = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:"
TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}

# What goes to the loudspeaker is measured too, and each audio context is counted.
METER = """
window.contexts = [];
window.AudioContext = class extends AudioContext {
  constructor(...options) { super(...options); window.contexts.push(this); }
};
const connect = AudioNode.prototype.connect;
AudioNode.prototype.connect = function (target, ...more) {
  if (target === this.context.destination && window.contexts.includes(this.context)) {
    window.meter = this.context.createAnalyser();
    window.meter.fftSize = 32768;
    connect.call(this, window.meter);
  }
  return connect.call(this, target, ...more);
};
window.peak = () => {
  if (!window.meter) return 0;
  const samples = new Float32Array(window.meter.fftSize);
  window.meter.getFloatTimeDomainData(samples);
  return Math.max(...samples.map(Math.abs));
};
"""
LOCKS = """
window.locks = [];
const request = WakeLock.prototype.request;
WakeLock.prototype.request = async function (kind) {
  const lock = await request.call(this, kind);
  window.locks.push(lock);
  return lock;
};
"""
GAMEPADS = """
window.plugged = [null, null, null, null];
navigator.getGamepads = () => window.plugged;
window.plug = (index, { x = 0, y = 0, down = [] } = {}) => {
  const isNew = window.plugged[index] === null;
  const isDown = (n) => down.includes(n);
  const buttons = Array.from({ length: 17 }, (_, n) => ({ pressed: isDown(n), value: Number(isDown(n)) }));
  window.plugged[index] = { index, id: "fake", connected: true, mapping: "standard", axes: [x, y, 0, 0], buttons };
  if (isNew) window.dispatchEvent(new Event("gamepadconnected"));
};
window.unplug = (index) => {
  window.plugged[index] = null;
  window.dispatchEvent(new Event("gamepaddisconnected"));
};
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the page, bundled as the game's own pages are."""
    folder = tmp_path_factory.mktemp("controls")
    bundle = [str(ROOT / "node_modules/.bin/esbuild"), "page.js", "--bundle", "--format=esm", "--target=es2022"]
    options = ["--loader:.woff2=empty", "--define:PICTURES={}", "--log-level=warning", f"--outdir={folder}"]
    subprocess.run([*bundle, *options], cwd=FOLDER, check=True)
    words = json.loads((ROOT / "server/static/words/en.json").read_text())
    (folder / "index.html").write_text((FOLDER / "index.html").read_text().replace("WORDS", json.dumps(words)))
    return folder


@pytest.fixture
def context(chromium: Browser, site: Path, request: pytest.FixtureRequest) -> Iterator[BrowserContext]:
    """A phone on its side, or what the test says."""
    made = new_context(chromium, site, **getattr(request, "param", {}))
    yield made
    made.close()


def new_context(browser: Browser, site: Path, **options: Any) -> BrowserContext:
    made = browser.new_context(**{"viewport": PHONE, "has_touch": True, "is_mobile": True, **options})

    def answer(route: Route) -> None:
        path = site / (route.request.url.removeprefix(HOME) or "index.html")
        if path.is_file():
            headers = {"Content-Type": TYPES[path.suffix], "Content-Security-Policy": POLICY}
            route.fulfill(body=path.read_text(), headers=headers)
        else:
            route.fulfill(status=404)

    made.route("**/*", answer)
    for script in (METER, LOCKS, GAMEPADS):
        made.add_init_script(script)
    return made


@pytest.fixture
def page(context: BrowserContext) -> Iterator[Page]:
    complaints: list[str] = []
    made = context.new_page()
    made.on("pageerror", lambda error: complaints.append(str(error)))
    made.goto(HOME)
    made.wait_for_function("() => window.game")
    yield made
    assert complaints == []


class Thumbs:
    """Fingers on the screen of `page`, each by its name; every change is a touch event of the browser's own."""

    def __init__(self, page: Page) -> None:
        self._cdp: CDPSession = page.context.new_cdp_session(page)
        self._places: dict[int, tuple[float, float]] = {}

    def put(self, finger: int, x: float, y: float) -> None:
        self._send("touchStart", finger, x, y)

    def move(self, finger: int, x: float, y: float) -> None:
        self._send("touchMove", finger, x, y)

    def lift(self, finger: int) -> None:
        self._send("touchEnd", finger, *self._places.pop(finger))

    def _send(self, kind: str, finger: int, x: float, y: float) -> None:
        """The other fingers stay as they are: an event names only those that change."""
        if kind != "touchEnd":
            self._places[finger] = (x, y)
        point = {"x": x, "y": y, "id": finger}
        self._cdp.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [point]})


@pytest.fixture
def thumbs(page: Page) -> Thumbs:
    return Thumbs(page)


def drive(page: Page) -> None:
    page.evaluate("game.driver.start()")


def command(page: Page) -> tuple[int, int, bool]:
    """The last command: linear, angular, shoot."""
    last = page.evaluate("game.sent.at(-1)")
    return last["linear_x"], last["angular_z"], last["shoot"]


def commanded(page: Page, linear: int, angular: int, *, shoot: bool = False) -> None:
    until(lambda: command(page) == (linear, angular, shoot), 5, f"the command {(linear, angular, shoot)}")


def place(page: Page, selector: str, x: float = 0.5, y: float = 0.5) -> tuple[float, float]:
    """A place in an element, from its left and top; 1 is its other side."""
    box = page.locator(selector).bounding_box()
    assert box is not None
    return box["x"] + x * box["width"], box["y"] + y * box["height"]


def peak(page: Page) -> float:
    """How loud it was in the last moments."""
    return float(page.evaluate("peak()"))


def heard(page: Page) -> None:
    until(lambda: peak(page) > 0.01, 5, "a sound")


def test_two_thumbs_drive_and_fire_at_once(page: Page, thumbs: Thumbs) -> None:
    drive(page)
    thumbs.put(1, *place(page, ".thumb-pad", 0.5, 0.1))
    commanded(page, 1, 0)
    thumbs.put(2, *place(page, ".thumb-fire"))
    commanded(page, 1, 0, shoot=True)
    expect(page.locator(".thumb-pad .is-held")).to_have_count(1)
    expect(page.locator(".thumb-fire.is-held")).to_be_visible()
    thumbs.move(1, *place(page, ".thumb-pad", 0.9, 0.1))
    commanded(page, 1, 1, shoot=True)
    thumbs.move(1, *place(page, ".thumb-pad", 1.8, 0.5))  # slid off its edge, it is the pad's all the same
    commanded(page, 0, 1, shoot=True)
    thumbs.lift(2)
    commanded(page, 0, 1)
    thumbs.put(3, *place(page, ".thumb-fire"))
    commanded(page, 0, 1, shoot=True)
    thumbs.lift(1)
    commanded(page, 0, 0, shoot=True)
    thumbs.lift(3)
    commanded(page, 0, 0)
    expect(page.locator(".is-held")).to_have_count(0)


def test_a_stick_comes_to_the_thumb_and_is_chosen_for_good(page: Page, thumbs: Thumbs) -> None:
    page.evaluate("scrollTo(0, document.body.scrollHeight)")
    page.get_by_label("Touch control").select_option("floating stick")
    page.reload()
    page.wait_for_function("() => window.game")
    expect(page.locator(".thumb-pad")).to_be_hidden()
    page.evaluate("scrollTo(0, 0)")
    drive(page)
    x, y = place(page, ".thumb-zone", 0.6, 0.4)
    thumbs.put(1, x, y)
    assert place(page, ".thumb-stick") == pytest.approx((x, y), abs=1)
    commanded(page, 0, 0)
    thumbs.move(1, x - 40, y)
    commanded(page, 0, -1)
    thumbs.put(2, *place(page, ".thumb-fire"))
    commanded(page, 0, -1, shoot=True)
    thumbs.put(3, x, y + 60)  # a third finger does not take the stick away
    thumbs.move(1, x - 140, y)
    commanded(page, 0, -1, shoot=True)
    thumbs.move(1, x - 50, y)  # far behind where it began: back is back
    commanded(page, 0, 1, shoot=True)
    for finger in (1, 2, 3):
        thumbs.lift(finger)
    commanded(page, 0, 0)
    left, bottom = place(page, ".thumb-stick")
    assert left < x - 40, "the stick has gone back to its place"
    assert bottom > y


def test_a_thumb_whose_control_goes_away_lets_go(page: Page, thumbs: Thumbs) -> None:
    drive(page)
    thumbs.put(1, *place(page, ".thumb-pad", 0.5, 0.9))
    commanded(page, -1, 0)
    page.evaluate("game.preferences.set('touch', 'stick')")
    commanded(page, 0, 0)
    thumbs.lift(1)
    commanded(page, 0, 0)


def test_in_battle_the_page_holds_still(page: Page, thumbs: Thumbs) -> None:
    def swipe() -> float:
        """How far the page has scrolled then."""
        page.evaluate("scrollTo(0, 0)")
        thumbs.put(1, 400, 200)
        for step in range(1, 9):
            thumbs.move(1, 400, 200 - 15 * step)
        thumbs.lift(1)
        return float(page.evaluate("scrollY"))

    def pinch() -> float:
        """How much it is zoomed then."""
        thumbs.put(1, 380, 150)
        thumbs.put(2, 460, 150)
        for step in range(1, 9):
            thumbs.move(1, 380 - 15 * step, 150)
            thumbs.move(2, 460 + 15 * step, 150)
        thumbs.lift(1)
        thumbs.lift(2)
        return float(page.evaluate("visualViewport.scale"))

    def asks_for_a_menu() -> bool:
        menu = "new MouseEvent('contextmenu', {bubbles: true, cancelable: true})"
        return bool(page.evaluate(f"text.dispatchEvent({menu})"))

    def selectable() -> str:
        return str(page.evaluate("getComputedStyle(text).userSelect"))

    drive(page)
    assert (swipe(), pinch()) == (0, 1)
    assert not asks_for_a_menu()
    assert selectable() == "none"
    page.evaluate("game.driver.stop()")
    assert asks_for_a_menu()
    assert selectable() != "none"
    # a busy browser may miss one
    until(lambda: swipe() > 0, 10, "the page scrolls")
    until(lambda: pinch() > 1, 10, "it zooms")


def test_a_gamepad_drives_as_soon_as_it_is_plugged_in(page: Page) -> None:
    hint = page.locator("#pad-hint")
    expect(hint).to_be_hidden()
    drive(page)
    page.evaluate("plug(0)")
    expect(hint).to_contain_text("left stick")
    page.evaluate("plug(0, {y: -1, down: [7]})")
    commanded(page, 1, 0, shoot=True)
    page.evaluate("plug(0, {down: [14]})")
    commanded(page, 0, -1)
    page.evaluate("plug(1, {y: 1})")
    commanded(page, -1, -1)
    page.evaluate("unplug(0)")
    commanded(page, -1, 0)
    page.evaluate("unplug(1)")
    commanded(page, 0, 0)
    expect(hint).to_be_hidden()


def test_start_is_ready_and_select_turns_the_sound_off(page: Page) -> None:
    page.evaluate("plug(0, {down: [8, 9]})")
    until(lambda: page.evaluate("game.readies.length") == 1, 5, "Start is heard")
    expect(page.locator("#sound")).to_have_attribute("aria-pressed", "false")
    page.evaluate("plug(0)")
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    page.evaluate("plug(0, {down: [8]})")
    expect(page.locator("#sound")).to_have_attribute("aria-pressed", "true")
    assert page.evaluate("game.readies.length") == 1


def test_a_gamepad_holds_nothing_under_a_dialog(page: Page) -> None:
    drive(page)
    page.evaluate("plug(0, {y: -1})")
    commanded(page, 1, 0)
    page.evaluate("document.body.append(document.createElement('dialog'))")
    page.evaluate("document.querySelector('dialog').showModal()")
    commanded(page, 0, 0)
    page.evaluate("document.querySelector('dialog').close()")
    commanded(page, 1, 0)


def tap_on_text(page: Page) -> None:
    page.locator("#text").tap()


def key(page: Page) -> None:
    page.keyboard.press("x")


@pytest.mark.parametrize("touch", [tap_on_text, key], ids=["tap", "key"])
def test_nothing_sounds_before_the_first_touch(page: Page, touch: Callable[[Page], None]) -> None:
    page.evaluate("for (const name of ['tick', 'go', 'hit', 'win']) game.speaker.play(name)")
    page.evaluate("game.speaker.repeat('heartbeat', 0.1)")
    assert page.evaluate("contexts.length") == 0
    page.evaluate("game.speaker.quiet()")
    touch(page)
    until(lambda: page.evaluate("contexts.map(({state}) => state).join()") == "running", 10, "one audio context runs")
    assert peak(page) == 0, "what was missed is not played later"
    page.evaluate("game.speaker.play('win')")
    heard(page)


def test_a_thumb_on_the_fire_button_is_a_first_touch_too(page: Page, thumbs: Thumbs) -> None:
    drive(page)
    for _ in range(2):
        thumbs.put(1, *place(page, ".thumb-fire"))
        commanded(page, 0, 0, shoot=True)
        thumbs.lift(1)
        until(lambda: page.evaluate("contexts[0]?.state") == "running", 10, "the audio context runs")
    page.evaluate("game.feedback.fire(performance.now() + 1000)")
    heard(page)


def test_the_heart_beats_until_it_is_quiet(page: Page) -> None:
    key(page)
    until(lambda: page.evaluate("contexts[0]?.state") == "running", 10, "the audio context runs")
    page.evaluate("game.speaker.repeat('heartbeat', 0.2)")
    heard(page)
    page.evaluate("game.speaker.quiet()")
    until(lambda: peak(page) == 0, 5, "silence")


def test_the_sound_stays_off_over_a_reload(page: Page) -> None:
    button = page.get_by_role("button", name="Sound")
    expect(button).to_have_attribute("aria-pressed", "true")
    button.click()
    page.reload()
    page.wait_for_function("() => window.game")
    expect(button).to_have_attribute("aria-pressed", "false")
    key(page)
    until(lambda: page.evaluate("contexts[0]?.state") == "running", 10, "the audio context runs")
    page.evaluate("game.speaker.play('win')")
    moment = page.evaluate("contexts[0].currentTime")
    until(lambda: page.evaluate("contexts[0].currentTime") > moment + 0.3, 10, "the sound would be heard by now")
    assert peak(page) == 0
    button.click()
    page.evaluate("game.speaker.play('win')")
    heard(page)


def test_each_sound_is_heard_and_none_is_too_loud(page: Page) -> None:
    loudness = page.evaluate("game.loudness()")
    assert len(loudness) == 12
    for name, loud in loudness.items():
        assert 0.1 < loud["peak"] <= 1, f"{name}: {loud}"
        assert loud["average"] > 0.01, f"{name}: {loud}"
    assert loudness["heartbeat"]["peak"] < loudness["hit"]["peak"]


@pytest.mark.slow  # by a whole Chromium: without windows, it keeps no screen awake
def test_the_screen_is_kept_awake_while_a_robot_is_driven(chromium: Browser, site: Path) -> None:
    whole = chromium.browser_type.launch(executable_path="/usr/bin/chromium", args=FLAGS)
    page = new_context(whole, site).new_page()
    page.goto(HOME)
    page.wait_for_function("() => window.game")
    assert page.evaluate("locks.length") == 0
    drive(page)
    until(lambda: page.evaluate("locks.some(({released}) => !released)"), 5, "the screen is kept awake")
    page.evaluate("game.driver.stop()")
    until(lambda: page.evaluate("locks.every(({released}) => released)"), 5, "the screen may sleep")
    whole.close()


def test_the_page_fills_the_screen_and_gives_it_back(page: Page) -> None:
    button = page.get_by_role("button", name="Full screen")
    for state in ("true", "false"):
        button.click()
        expect(button).to_have_attribute("aria-pressed", state)
        assert page.evaluate("String(document.fullscreenElement !== null)") == state


@pytest.mark.parametrize("context", [{"reduced_motion": "reduce"}, {}], ids=["calm", "full"], indirect=True)
def test_a_hit_shakes_only_those_who_like_motion(page: Page, request: pytest.FixtureRequest) -> None:
    state = {"game": 2, "battle": 1, "paused": False, "timeLeft": 9, "result": []}
    before, after = ({**state, "users": [{"name": "Ann", "life": life, "ready": True}]} for life in (100, 90))
    moving = page.evaluate(
        """([before, after]) => {
             game.feedback.take(before, after, "Ann");
             game.feedback.take(before, after, "Ann");
             return [stage.getAnimations().length > 0, flash.getAnimations().length];
           }""",
        [before, after],
    )
    assert moving == ["full" in request.node.name, 1]
