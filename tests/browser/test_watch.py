"""The screen for spectators, in a real browser on the whole chain."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import requests
import segno
from playwright.sync_api import Browser, Page, WebSocketRoute, expect

from tests.browser.axe import violations
from tests.support.demo import TOKEN, Demo
from tests.support.play import hunt_down, shoot_to_the_end, start
from tests.support.player import Eyes, Player, players_and_free_robots
from tests.support.polling import LATEST, until

PROJECTOR = {"width": 1920, "height": 1080}


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(hit_damage=25, countdown=3)
    return demo


@pytest.fixture
def screen(chromium: Browser, battle: Demo) -> Iterator[Page]:
    """The page on a projector; nothing in it may fail."""
    context = chromium.new_context(viewport=PROJECTOR, color_scheme="light")  # type: ignore[arg-type]
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.clock.install()  # it goes on as any clock does, and can be put forward
    page.goto(f"{battle.web}/watch")
    yield page
    context.close()
    assert complaints == []


def panel(name: str) -> re.Pattern[str]:
    return re.compile(rf"^{name}$")


def width_of(page: Page, selector: str) -> float:
    box = page.locator(selector).bounding_box()
    assert box
    return box["width"]


def test_a_spectator_sees_a_whole_battle(screen: Page, battle: Demo, screenshots: Path) -> None:
    body, players, feed = screen.locator("body"), screen.locator("#players"), screen.locator("#feed")
    expect(body).to_have_attribute("data-panel", panel("join"))
    expect(screen.locator("html")).to_have_attribute("data-theme", "dark")  # as halls are, whatever the system is
    expect(screen.locator(".watch-address")).to_have_text(battle.web.removeprefix("http://"))
    drawn = screen.locator(".watch-code svg path").last.get_attribute("d")
    assert drawn
    large = width_of(screen, ".watch-code")
    assert f'd="{drawn}"' in segno.make(battle.web, micro=False, error="m").svg_inline(border=4)
    expect(screen.locator("#arena")).to_be_visible()
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        expect(players).to_contain_text("Ann")
        expect(players).to_contain_text("Bob")
        expect(feed).to_contain_text("Bob is here")
        screen.screenshot(path=screenshots / "watch-join.png")
        assert (ann.ready(), bob.ready()) == ("OK", "OK")
        expect(screen.locator("#countdown")).to_have_text(re.compile("^[123]$"))
        start(ann, bob)
        expect(body).to_have_attribute("data-panel", panel("battle"))
        expect(screen.locator("#clock strong")).to_have_text(re.compile(r"^[45]:\d\d$"))
        assert 0 < width_of(screen, ".watch-code") < large / 2, "it makes room for the battle"
        hunt_down(ann, bob, eyes, 75)
        expect(feed).to_contain_text("Ann hits Bob: 75%")  # nobody else has shot
        expect(players.locator("[data-name=Bob] [role=progressbar]")).not_to_have_attribute("aria-valuenow", "100")
        expect(players.locator("[data-name=Ann] [role=progressbar]")).to_have_attribute("aria-valuenow", "100")
        screen.screenshot(path=screenshots / "watch-battle.png")
        shoot_to_the_end(ann, bob, eyes)
        expect(body).to_have_attribute("data-panel", panel("podium"))
        expect(screen.locator("[data-metal=gold]")).to_contain_text("Ann")
        expect(screen.locator("[data-metal=silver]")).to_contain_text("Bob")
        screen.screenshot(path=screenshots / "watch-podium.png")
        screen.clock.fast_forward("01:00")  # longer than the podium stays, and than news count as new
        expect(body).to_have_attribute("data-panel", panel("leaders"))
        expect(screen.locator("#leaders tbody tr").first).to_contain_text("Ann")
        expect(feed.locator("li")).to_have_count(6)  # the newest, and by now all are old
        expect(feed.locator("li.is-old")).to_have_count(6)
        expect(feed.locator("li").first).to_have_text("Ann wins!")
        screen.screenshot(path=screenshots / "watch-leaders.png")


def test_who_waits_is_told_in_order(screen: Page, battle: Demo) -> None:
    with Player(battle, "Ann"), Player(battle, "Bob"), requests.Session() as cy, requests.Session() as di:
        waiting = {"Cy": cy, "Di": di}
        for name, http in waiting.items():
            assert (
                '"QUEUED"' in http.post(f"{battle.web}/signUpUser", data={"data": name, "wait": 1}, timeout=LATEST).text
            )
        expect(screen.locator("#queue-names")).to_have_text("Cy and Di")
        for name, http in waiting.items():
            http.post(f"{battle.web}/signOutUser", data={"data": name}, timeout=LATEST)
        expect(screen.locator("#queue")).to_be_hidden()


def test_people_who_watch_cheer_and_vote_and_the_operator_applies_what_they_chose(
    screen: Page, chromium: Browser, battle: Demo, screenshots: Path
) -> None:
    phone = chromium.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    desk = chromium.new_context()
    watching, operating = phone.new_page(), desk.new_page()
    watching.goto(f"{battle.web}/watch")
    desk.request.post(f"{battle.web}/operator/login", form={"token": TOKEN, "name": "Otto"})
    operating.goto(f"{battle.web}/operator")
    with Player(battle, "Ann"), Player(battle, "Bob"):
        watching.locator("[data-name=Ann].cheer").click()
        expect(screen.locator("[data-name=Ann].cheer b")).to_have_text("1")
        for preset in ("Children", "Short rounds"):
            operating.locator("#vote-presets").get_by_label(preset).check()
        operating.get_by_role("button", name="Start the vote").click()
        watching.get_by_role("button", name="Short rounds").click()
        expect(screen.locator("#vote-choices li").last).to_contain_text("1 vote")
        expect(watching.get_by_role("button", name="Short rounds")).to_have_attribute("aria-pressed", "true")
        watching.get_by_role("button", name="Children").click()  # somebody thinks again
        expect(screen.locator("#vote-choices li").first).to_contain_text("1 vote")
        screen.screenshot(path=screenshots / "watch-vote.png")
        watching.screenshot(path=screenshots / "watch-vote-390.png")
        assert violations(screen) + violations(watching) == []
        operating.get_by_role("button", name="End it now").click()
        expect(screen.locator("#vote-title")).to_have_text("The audience has chosen")
        operating.get_by_role("button", name="Apply: Children").click()
        expect(operating.locator("#rule-hit_damage")).to_have_value("5")
    for context in (phone, desk):
        context.close()


@pytest.mark.slow
def test_a_killed_server_is_told_and_found_again(screen: Page, battle: Demo) -> None:
    expect(screen.locator("#headline")).not_to_have_text("Connecting...")
    with battle.pause(r"python3 -m server\.main"):
        expect(screen.locator("#banner")).to_have_text("The server does not answer. This page keeps trying.")
    expect(screen.locator("#banner")).to_be_hidden()
    battle.kill(r"python3 -m server\.main")
    until(lambda: players_and_free_robots(battle) == ([], 2), 30, "the server is back")
    with Player(battle, "Eve"):
        expect(screen.locator("#players")).to_contain_text("Eve")
    expect(screen.locator("#banner")).to_be_hidden()


def test_without_a_place_at_rosbridge_the_state_comes_by_http_and_keeps_nobody_signed_in(
    chromium: Browser, battle: Demo
) -> None:
    def refuse(socket: WebSocketRoute) -> None:
        socket.close()

    context = chromium.new_context()
    context.request.post(f"{battle.web}/signUpUser", form={"data": "Ann"})
    page = context.new_page()
    page.route_web_socket(battle.bridge, refuse)
    with page.expect_response("**/watch.json") as asked:
        page.goto(f"{battle.web}/watch")
    expect(page.locator("#players")).to_contain_text("Ann")
    assert context.cookies()
    assert "cookie" not in asked.value.request.all_headers()
    context.request.post(f"{battle.web}/signOutUser", form={"data": "Ann"})
    expect(page.locator("#players")).not_to_contain_text("Ann")
    context.close()


@pytest.mark.parametrize(
    "viewport", [(390, 844), *(pytest.param(size, marks=pytest.mark.slow) for size in ((1280, 720), (844, 390)))]
)
def test_it_fits_every_screen(viewport: tuple[int, int], screen: Page, battle: Demo, screenshots: Path) -> None:
    width, height = viewport
    screen.set_viewport_size({"width": width, "height": height})
    expect(screen.locator("#nobody")).to_have_js_property("hidden", False)  # who was there before the page is no news
    with Player(battle, "Ann"), Player(battle, "Bob"):
        expect(screen.locator("#feed")).to_contain_text("Bob")
        size = screen.evaluate("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]")
        assert size[0] <= width
        assert size[1] <= height or height > width, "only an upright phone scrolls"
        screen.screenshot(path=screenshots / f"watch-{width}x{height}.png")


def test_the_keyboard_leads_to_the_game_and_to_the_language(screen: Page, battle: Demo) -> None:
    reached = set()
    for _ in range(8):
        screen.keyboard.press("Tab")
        reached.add(screen.evaluate("document.activeElement.getAttribute('href') ?? document.activeElement.className"))
    assert {"/", "square"} <= reached
    screen.locator(".watch-top .square").focus()
    screen.keyboard.press("Enter")
    screen.locator("#language").select_option("de")
    expect(screen.locator("#join-title")).to_have_text("Spiel mit!")
