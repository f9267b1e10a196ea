"""Somebody at a browser of their own."""

from typing import Protocol

from playwright.sync_api import Browser, BrowserContext, Page, expect

from tests.support.player import Place

ARROWS = {
    "ArrowUp": lambda linear, angular, shoot: linear > 0,
    "ArrowDown": lambda linear, angular, shoot: linear < 0,
    "ArrowLeft": lambda linear, angular, shoot: angular < 0,
    "ArrowRight": lambda linear, angular, shoot: angular > 0,
    "Space": lambda linear, angular, shoot: shoot,
}

# where a page looks for the cameras, nobody is
WITHOUT_CAMERAS = """
window.WebSocket = class extends WebSocket {
  constructor(url, ...more) { super(new URL(url).port === "%d" ? "ws://127.0.0.1:1/" : url, ...more); }
};
"""

# the page as it is where nothing tells where the robots are
WITHOUT_ARENA = """
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (text) { if (!String(text).includes('"/positions"')) send.call(this, text); };
"""
DESKTOP = (1280, 800)


class Site(Place, Protocol):
    """A place to play with pages and cameras."""

    @property
    def relay_port(self) -> int: ...


class Person:
    """Somebody at a browser of their own."""

    def __init__(
        self,
        chromium: Browser,
        battle: Site,
        name: str,
        *,
        policy: bool = True,
        locale: str = "en-GB",
        camera: bool = False,
        arena: bool = False,
        phone: tuple[int, int] | None = None,
    ) -> None:
        """`policy`: whether the browser heeds the Content-Security-Policy. `camera`, `arena`: whether the pages show
        what the robots' cameras see, and the arena from above; to paint either costs half a processor. `phone`: the
        width and height of a phone's screen, if it is one."""
        self.name, self.battle = name, battle
        width, height = phone or DESKTOP
        self.context: BrowserContext = chromium.new_context(
            viewport={"width": width, "height": height},
            bypass_csp=not policy,
            locale=locale,
            has_touch=phone is not None,
            is_mobile=phone is not None,
        )
        if not camera:
            self.context.add_init_script(WITHOUT_CAMERAS % battle.relay_port)
        if not arena:
            self.context.add_init_script(WITHOUT_ARENA)
        self.page: Page = self.context.new_page()
        self.complaints: list[str] = []
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(battle.web)
        self.pressed: set[str] = set()
        self.robot = -1  # until logged in

    def log_in(self) -> None:
        expect(self.page.locator("#availableR")).not_to_have_attribute("data-count", "0")
        self.page.locator("#username").fill(self.name)
        self.page.locator("#username").press("Enter")
        self.page.wait_for_url("**/home")
        expect(self.page.locator(".username").first).to_have_text(self.name)
        self.robot = int(self.page.locator(".robotN").first.inner_text().split()[-1])

    def hold(self, command: tuple[int, int, bool]) -> None:
        """Hold exactly the keys of this command."""
        wanted = {key for key, held in ARROWS.items() if held(*command)}
        for key in self.pressed - wanted:
            self.page.keyboard.up(key)
        for key in wanted - self.pressed:
            self.page.keyboard.down(key)
        self.pressed = wanted
