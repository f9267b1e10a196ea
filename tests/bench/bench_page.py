"""The game page: what it weighs, what it costs, and under a busy stage pictures/s and key press -> WebSocket.

Run by `make bench`. Chromium draws in software at 1280x720. Three virtual robots, one of them a bot's, and the page's
player in a battle, who drives and shoots. Then five more are played to the arena over its link, driving in circles
with their beams on and off.
"""

import asyncio
import itertools
import math
import statistics
import threading
import time
from collections.abc import Callable

from playwright.sync_api import Page, ViewportSize, sync_playwright

from tests.bench.spending import BROWSER, spending
from tests.browser.conftest import CHROMIUM, FLAGS
from tests.browser.weight import Weight
from tests.support.battle import Battle
from tests.support.polling import until

ROBOTS = 3
EXTRAS = 5  # robots that only the arena knows
SECONDS = 10.0  # of each measurement
PRESSES = 100
SIZE: ViewportSize = {"width": 1280, "height": 720}
GOAL = 60  # pictures/s
BUDGET = 35  # % of a core
WHOLE_BUDGET = 90  # with all that the battle is made of
TOOLS = {"node"}  # Playwright's

# Runs in the page: frames of the page itself, pictures of the arena, each of which begins with its floor, and when a
# key's command was sent.
WATCH = """() => {
  window.seen = {frames: [], pictures: 0, delays: []};
  const frame = now => { seen.frames.push(now); requestAnimationFrame(frame); };
  requestAnimationFrame(frame);
  const drawImage = CanvasRenderingContext2D.prototype.drawImage;
  CanvasRenderingContext2D.prototype.drawImage = function (image, ...more) {
    seen.pictures += this.canvas.parentElement?.id === 'arena' && image.width === this.canvas.width;
    return drawImage.call(this, image, ...more);
  };
  let pressed = null;
  addEventListener('keydown', event => { if (!event.repeat) pressed = event.timeStamp; }, true);
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (text) {
    if (pressed !== null && String(text).includes('/command')) {
      seen.delays.push(performance.now() - pressed);
      pressed = null;
    }
    return send.call(this, text);
  };
}"""


class Crowd:
    """Robots on the arena's floor without a firmware: each drives in a circle and fires every other second."""

    def __init__(self, port: int, robots: int) -> None:
        self._port, self._robots = port, robots
        self._over = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._drive()))

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    async def _drive(self) -> None:
        ends = [await asyncio.open_connection("127.0.0.1", self._port) for _ in range(self._robots)]
        for number, (_, writer) in enumerate(ends):
            writer.write(f"robot extra{number}\n".encode())
        start = time.monotonic()
        while not self._over.is_set():
            spent = time.monotonic() - start
            for number, (_, writer) in enumerate(ends):
                turned = int(spent * 700)
                writer.write(b"wheels %d %d\n" % (turned, int(turned * (0.5 + 0.05 * number))))
                writer.write(b"beam %d\n" % (math.floor(spent + number / 3) % 2))
            await asyncio.sleep(0.04)
        for _, writer in ends:
            writer.close()


def enter(page: Page) -> None:
    page.locator("#username").press("Enter")
    page.wait_for_url("**/home")


def main() -> None:
    with (
        Battle(robots=ROBOTS, bots=1, LASERBOT_COUNTDOWN="1", LASERBOT_HIT_DAMAGE="1") as battle,
        sync_playwright() as playwright,
    ):
        battle.wait_until_ready()
        browser = playwright.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)
        page = browser.new_context(viewport=SIZE).new_page()
        weight = Weight(page)
        page.goto(battle.web)
        print(f"login page: {weight.settled() / 1000:.0f} kB")
        page.locator("#username").fill("Ann")
        enter(page)
        print(f"to the first playable picture: {weight.settled() / 1000:.0f} kB (goal 150)")
        until(lambda: page.locator("#camera").is_visible(), 60, "the camera's picture")
        print_cost("lobby, camera", lambda: page.wait_for_timeout(SECONDS * 1000))
        page.locator("#ready-btn").click()
        until(lambda: page.locator("body").get_attribute("data-phase") == "playing", 60, "the battle")
        print_cost("battle, camera", lambda: drive(page))
        page.keyboard.press("v")
        print_cost("battle, arena", lambda: drive(page))
        with Crowd(battle.ports["LASERBOT_ARENA_LINK_PORT"], EXTRAS):
            measure(page)
        browser.close()


def print_cost(what: str, act: Callable[[], object]) -> None:
    found = {program: share for program, share in spending(act).items() if program not in TOOLS}
    page = {program.removeprefix(BROWSER): share for program, share in found.items() if program.startswith(BROWSER)}
    print(f"CPU of the page, {what}: {sum(page.values()):.0f} % of a core (goal {BUDGET}): {_listed(page)}")
    rest = {program: share for program, share in found.items() if not program.startswith(BROWSER)}
    print(f"    with the battle {sum(found.values()):.0f} % (goal {WHOLE_BUDGET}): {_listed(rest)}", flush=True)


def _listed(parts: dict[str, float]) -> str:
    ordered = sorted(parts.items(), key=lambda part: -part[1])
    return ", ".join(f"{name} {share:.1f}" for name, share in ordered if share >= 0.5)


def drive(page: Page) -> None:
    """Forwards, backwards and round, with a shot each second."""
    for key in itertools.islice(itertools.cycle(("ArrowUp", "ArrowLeft", "ArrowDown", "ArrowRight")), int(SECONDS)):
        page.keyboard.down(key)
        page.keyboard.press("Space", delay=400)
        page.wait_for_timeout(500)
        page.keyboard.up(key)
        page.wait_for_timeout(100)


def measure(page: Page) -> None:
    page.evaluate(WATCH)
    for _ in range(PRESSES):
        page.keyboard.down("ArrowLeft")
        page.wait_for_timeout(SECONDS * 500 / PRESSES)
        page.keyboard.up("ArrowLeft")
        page.wait_for_timeout(SECONDS * 500 / PRESSES)
    seen = page.evaluate("() => seen")
    frames = seen["frames"]
    rate = 1000 * (len(frames) - 1) / (frames[-1] - frames[0])
    print(f"the page with {ROBOTS + EXTRAS} robots: {rate:.0f} pictures/s (goal {GOAL})")
    print(f"the arena on it: {seen['pictures'] / (frames[-1] - frames[0]) * 1000:.0f} pictures/s")
    delays = sorted(seen["delays"])
    print(
        f"key press -> WebSocket: n={len(delays)}, p50 {statistics.median(delays):.1f} ms, "
        f"p99 {delays[int(0.99 * len(delays))]:.1f} ms, max {delays[-1]:.1f} ms"
    )


if __name__ == "__main__":
    main()
