"""What the pages offer and how they take it when something goes wrong, in a real browser on the whole chain."""

import re
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.people import WITHOUT_CAMERAS, Person
from tests.browser.weight import Weight
from tests.support.battle import Paused
from tests.support.demo import Demo
from tests.support.play import start
from tests.support.player import Eyes, Player
from tests.support.polling import until

STILL = 40  # equal views in a row, at 25 Hz
# A cookie goes to one host name: the WebSocket to another name of this machine is without it. While `muted`, the page
# cannot say whose it is.
NO_COOKIE = """
window.muted = true;
window.WebSocket = class extends WebSocket {
  constructor(url, ...more) { super(url.replace("127.0.0.1", "localhost"), ...more); }
  send(text) { if (!window.muted || !text.includes('"op":"auth"')) super.send(text); }
};
"""


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=1)
    return demo


def dialog_of(page: Page) -> str:
    """The text of the open dialog, waited for; read at sight, for some are gone in a moment."""
    return str(page.wait_for_function("() => document.querySelector('dialog[open]')?.innerText").json_value())


def test_a_newcomer_plays_after_150_kilobytes(chromium: Browser, battle: Demo) -> None:
    with chromium.new_context() as context:
        context.add_init_script(WITHOUT_CAMERAS % battle.relay_port)
        page = context.new_page()
        weight = Weight(page)
        try:
            page.goto(battle.web)
            assert 30_000 < weight.settled() < 100_000  # the arena behind it, too
            page.locator("#username").fill("Ann")
            page.locator("#username").press("Enter")
            page.wait_for_url("**/home")
            expect(page.locator("#ready-btn")).to_be_visible()
            assert weight.settled() < 150_000
        finally:
            context.request.post(f"{battle.web}/signOutUser", form={"data": "Ann"})


def test_a_click_changes_the_avatar_and_others_see_it(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    picture = ann.page.locator("#userImage")
    seen = {picture.get_attribute("src")}
    for _ in range(4):
        ann.page.locator("#avatar").click()
        seen.add(picture.get_attribute("src"))
    assert len(seen) == 5
    chosen = str(picture.get_attribute("src"))
    ann.log_in()
    assert ann.page.locator(".userImage").first.get_attribute("src") == chosen
    with Player(battle, "Bob") as bob:
        until(lambda: bob.user("Ann"), 5)
        assert f"/avatar{bob.user('Ann')['avatar']}-" in chosen


def test_a_bad_name_and_a_taken_name_are_explained(person: Callable[[str], Person], battle: Demo) -> None:
    with Player(battle, "Bob"):
        eve = person("Eve Lee")
        field, rule = eve.page.locator("#username"), eve.page.locator("#name-rule")
        expect(rule).to_contain_text("Up to 16 letters")
        field.fill("Eve!")
        expect(field).to_have_attribute("aria-invalid", "true")
        field.press("Enter")
        expect(rule).to_contain_text("Please use 1 to 16 letters")
        expect(field).to_be_focused()
        expect(eve.page.locator("dialog")).to_have_count(0)
        field.fill("Bob")
        field.press("Enter")
        assert "Name taken" in dialog_of(eve.page)
        eve.page.keyboard.press("Escape")
        eve.log_in()


@pytest.mark.slow
def test_enter_counts_as_soon_as_a_message_is_gone(person: Callable[[str], Person], battle: Demo) -> None:
    with Player(battle, "Bob"):
        eve = person("Bob")
        eve.page.locator("#username").fill("Bob")
        eve.page.locator("#username").press("Enter")
        assert "Name taken" in dialog_of(eve.page)
        eve.page.evaluate("document.querySelector('dialog').close(); document.querySelector('#login').requestSubmit()")
        assert "Name taken" in dialog_of(eve.page)


def test_without_a_free_robot_one_waits_and_takes_the_one_that_is_offered(
    person: Callable[[str], Person], battle: Demo
) -> None:
    ann, bea = person("Jörg"), person("Bea")
    with Player(battle, "One") as one, Player(battle, "Two"):
        for waiting in (ann, bea):
            waiting.page.locator("#username").fill(waiting.name)
            waiting.page.locator("#username").press("Enter")
            expect(waiting.page.locator("#queue")).to_be_visible()
        expect(ann.page.locator("#queue-title")).to_have_text("You are next.")
        expect(bea.page.locator("#queue-title")).to_have_text("You are number 2 in the queue.")
        bea.page.reload()
        expect(bea.page.locator("#queue-title")).to_have_text("You are number 2 in the queue.")
        one.post("signOutUser", data="One")
        expect(ann.page.locator("#queue-title")).to_have_text(f"Robot {one.robot} is yours!")
        expect(ann.page.locator("#take")).to_be_focused()
        ann.page.keyboard.press("Enter")
        ann.page.wait_for_url("**/home")
        expect(ann.page.locator(".robotN").first).to_have_text(f"Robot {one.robot}")
        expect(bea.page.locator("#queue-title")).to_have_text("You are next.")
        bea.page.locator("#leave").click()
        expect(bea.page.locator("#queue")).to_be_hidden()
        expect(bea.page.locator("#username")).to_be_visible()


def go_to(page: Page, selector: str) -> None:
    """With the Tab key only."""
    for _ in range(60):
        if page.evaluate("selector => document.activeElement.matches(selector)", selector):
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"Tab does not come to {selector}")


def test_the_keyboard_is_enough_from_the_login_to_the_way_out(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    page = ann.page
    with Player(battle, "Bob") as bob:
        go_to(page, "#username")
        page.keyboard.type("Ann")
        page.keyboard.press("Enter")
        page.wait_for_url("**/home")
        expect(page.locator("#seats")).to_contain_text("Ann")
        for way in (["#how-to"], [".user-button", "#settings"]):
            for button in way:
                go_to(page, button)
                page.keyboard.press("Enter")
            expect(page.locator("dialog[open]")).to_be_visible()
            page.keyboard.press("Escape")
            expect(page.locator("dialog[open]")).to_have_count(0)
        go_to(page, "#ready-btn")
        page.keyboard.press("Enter")
        expect(page.locator("#ready-btn")).to_have_attribute("aria-pressed", "true")
        assert bob.ready() == "OK"
        expect(page.locator("body")).to_have_attribute("data-phase", "playing")
        sound = page.locator("#sound")
        sound.click()
        is_on = str(sound.get_attribute("aria-pressed"))
        ann.hold((1, 0, True))
        expect(page.locator("#pilot")).to_have_attribute("data-held", re.compile("up shoot|shoot up"))
        ann.hold((0, 0, False))
        expect(sound, "whoever has clicked it goes on shooting").to_have_attribute("aria-pressed", is_on)
        for button in (".user-button", "#sign-out"):
            go_to(page, button)
            page.keyboard.press("Enter")
        expect(page.locator("dialog[open]")).to_be_visible()
        page.keyboard.press("Enter")
        expect(page.locator("#username")).to_be_visible()


def test_a_robot_can_be_chosen_until_somebody_else_has_it(person: Callable[[str], Person], battle: Demo) -> None:
    ann, bea = person("Ann"), person("Bea")
    for page in (ann.page, bea.page):
        page.locator("#robot").select_option("Robot 1")
    ann.log_in()
    assert ann.robot == 1
    bea.page.locator("#username").fill("Bea")
    bea.page.locator("#username").press("Enter")
    assert "Robot 1 is not free" in dialog_of(bea.page)
    bea.page.keyboard.press("Escape")
    bea.log_in()
    assert bea.robot == 0


def test_a_newcomers_first_key_press_moves_the_robot(person: Callable[[str], Person], battle: Demo) -> None:
    battle.play_by(practice=True)
    ann = person("Ann")
    with Eyes(battle) as eyes:
        ann.log_in()
        expect(ann.page.locator("body")).to_have_attribute(
            "data-phase", re.compile(".")
        )  # the page has heard how things stand
        heading = eyes.robots()[ann.robot]["heading"]
        ann.hold((0, 1, False))
        until(lambda: eyes.robots()[ann.robot]["heading"] != heading, 10, "the keys move the robot")
        ann.hold((0, 0, False))


def test_while_nobody_can_be_hit_the_pages_say_so(person: Callable[[str], Person], battle: Demo) -> None:
    battle.play_by(countdown=1, protection=4)
    ann = person("Ann")
    ann.log_in()
    shield = ann.page.locator("#own-protected")
    expect(shield).to_be_hidden()
    hall = ann.context.new_page()
    hall.goto(f"{battle.web}/watch")
    with Player(battle, "Bob") as bob:
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(shield).to_have_attribute("title", re.compile(r"^Safe for [1-4] s$"))
        expect(shield.locator("b")).to_be_visible()
        expect(hall.locator("#headline")).to_have_text(re.compile(r"^Nobody can be hit for [1-4] s$"))
        expect(shield).to_be_hidden()
        expect(hall.locator("#headline")).to_have_text("2 are still standing")


def test_who_waits_while_others_fight_sees_the_arena_and_who_they_are(
    person: Callable[..., Person], battle: Demo, screenshots: Path
) -> None:
    ann = person("Ann", arena=True)
    with Player(battle, "Bob") as bob, Player(battle, "Cy") as cy:
        start(bob, cy)
        ann.page.locator("#username").fill("Ann")
        ann.page.locator("#username").press("Enter")
        expect(ann.page.locator("#queue-battle")).to_have_text("In the battle: Bob and Cy")
        expect(ann.page.locator("body")).to_have_class(re.compile("has-arena"))
        ann.page.screenshot(path=screenshots / "queue-battle.png")
        panel, size = ann.page.locator("#login").bounding_box(), ann.page.viewport_size
        assert panel
        assert size
        assert panel["y"] > size["height"] / 2, "the middle of the arena is free"


def test_help_is_on_both_pages(person: Callable[[str], Person]) -> None:
    ann = person("Ann")
    for log_in in (lambda: None, ann.log_in):
        log_in()
        ann.page.locator("#how-to").click()
        assert "fire the laser" in dialog_of(ann.page)
        ann.page.keyboard.press("Escape")


def test_home_without_a_login_leads_back(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.page.goto(f"{battle.web}/home", wait_until="commit")
    assert "You are not logged in" in dialog_of(ann.page)
    ann.page.wait_for_url(f"{battle.web}/")


def test_a_session_can_be_restored_or_given_up(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    ann.page.goto(battle.web)
    expect(ann.page.locator("#restore-title")).to_have_text("You are logged in as “Ann”.")
    expect(ann.page.locator("#go-on")).to_be_focused()
    ann.page.keyboard.press("Escape")  # is no answer
    expect(ann.page.locator("#username")).to_be_hidden()
    ann.page.keyboard.press("Enter")
    ann.page.wait_for_url("**/home")
    ann.page.goto(battle.web)
    ann.page.locator("#restore #sign-out").click()
    expect(ann.page.locator("#availableR")).to_have_text("2 robots are free")
    expect(ann.page.locator("#username")).to_be_focused()


def test_signing_out_is_asked_and_can_be_cancelled(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    for answer in ("Cancel", "Sign out"):
        ann.page.locator(".user-button").click()
        ann.page.locator("#sign-out").click()
        assert "Sign out?" in dialog_of(ann.page)
        expect(ann.page.locator("#user-card")).to_be_hidden()  # it would lie over the question
        ann.page.locator("dialog[open] button", has_text=answer).click()
    assert "Signed out" in dialog_of(ann.page)
    ann.page.wait_for_url(f"{battle.web}/")
    expect(ann.page.locator("#availableR")).to_have_text("2 robots are free")


def test_a_window_that_loses_the_focus_stops_the_robot_though_the_key_is_held(
    person: Callable[[str], Person], battle: Demo
) -> None:
    ann = person("Ann")
    ann.log_in()
    with Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(ann.page.locator("#game-status")).to_contain_text("PLAY!")
        before = eyes.robots()[ann.robot]["heading"]
        ann.page.keyboard.down("ArrowRight")
        until(lambda: abs(eyes.robots()[ann.robot]["heading"] - before) > 0.1, 5, "the robot turns")
        ann.page.evaluate("window.dispatchEvent(new Event('blur'))")
        headings: list[float] = []

        def still() -> bool:
            headings.append(eyes.robots()[ann.robot]["heading"])
            return len(headings) > STILL and len(set(headings[-STILL:])) == 1

        until(still, 5, "the robot stands")
        ann.page.keyboard.up("ArrowRight")


def test_a_socket_without_the_cookie_is_signed_in_and_until_then_its_player_is_told(
    person: Callable[..., Person], battle: Demo
) -> None:
    ann = person("Ann", policy=False)  # which allows no WebSocket to another host
    ann.page.add_init_script(NO_COOKIE)
    ann.log_in()
    with Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(ann.page.locator("#game-status")).to_have_text("Your robot does not obey")
        expect(ann.page.locator("#game-hint")).to_contain_text("not signed in")
        before = eyes.robots()[ann.robot]["heading"]
        ann.page.keyboard.down("ArrowRight")
        expect(ann.page.locator("[data-action=right].is-held").first).to_be_visible()
        assert eyes.robots()[ann.robot]["heading"] == before
        ann.page.evaluate("window.muted = false")
        until(lambda: abs(eyes.robots()[ann.robot]["heading"] - before) > 0.1, 10, "the robot turns")
        expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
        ann.page.keyboard.up("ArrowRight")


@pytest.mark.slow
def test_a_robot_that_starts_again_is_still_its_players(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    battle.kill(rf"avr_robot .*--name virtual{ann.robot} ")
    ready = ann.page.locator("#ready-btn")

    def after_a_click(is_so: Callable[[], bool]) -> bool:
        ready.click()
        return is_so()

    until(lambda: after_a_click(lambda: "does not answer" in ann.page.locator("body").inner_text()), 15, "it is told")
    until(lambda: after_a_click(lambda: ready.get_attribute("aria-pressed") == "true"), 30, "the robot is back")


@pytest.mark.slow
def test_who_is_forgotten_by_a_server_that_was_away_is_told_so(person: Callable[[str], Person]) -> None:
    ann = person("Ann")
    ann.log_in()
    expect(ann.page.locator("#connection-state")).to_contain_text("Online")
    # as after a loss of data
    ann.page.route("**/session", lambda route: route.fulfill(json={"status": "UNREGISTERED"}))
    ann.page.route("**/updateGameStatus", lambda route: route.abort())
    expect(ann.page.locator("#banner")).to_contain_text("The server does not answer")
    ann.page.unroute("**/updateGameStatus")
    assert "The game has restarted" in dialog_of(ann.page)


BUSY = "seconds => { const end = Date.now() + 1000 * seconds; while (Date.now() < end) { /* as a slow machine */ } }"


@pytest.mark.slow
def test_a_page_that_is_too_busy_to_say_so_is_still_there(person: Callable[[str], Person], battle: Demo) -> None:
    battle.play_by(player_timeout=8, seat_timeout=8)
    ann = person("Ann")
    ann.log_in()
    expect(ann.page.locator("#connection-state")).to_contain_text("Online")
    ann.page.evaluate(BUSY, 14)
    assert ann.page.request.get(f"{battle.web}/session").json()["status"] == "OK"
    expect(ann.page.locator("#ready-btn")).to_be_visible()


@pytest.mark.slow
def test_in_each_state_the_page_outlives_a_while_offline(person: Callable[[str], Person], battle: Demo) -> None:
    battle.play_by(countdown=8)
    with Player(battle, "Bob") as bob:
        ann, cem = person("Ann"), person("Cem")
        banner = ann.page.locator("#banner")

        def offline(told: str, who: Person = ann) -> None:
            who.context.set_offline(True)
            expect(who.page.locator(told)).to_be_visible()
            who.context.set_offline(False)
            expect(who.page.locator(told)).to_be_hidden()

        expect(ann.page.locator("#availableR")).to_have_text("1 robot is free")
        offline(".login-connection")
        ann.log_in()
        offline("#banner")
        cem.page.locator("#username").fill("Cem")
        cem.page.locator("#username").press("Enter")
        expect(cem.page.locator("#queue-title")).to_be_visible()
        offline(".login-connection", cem)
        expect(cem.page.locator("#queue-title")).to_be_visible()
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(ann.page.locator("#countdown")).to_be_visible()
        offline("#banner")
        expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
        offline("#banner")
        expect(banner).to_be_hidden()
        assert bob.ready() == "STARTED"
        bob.post("signOutUser", data="Bob")
        expect(ann.page.locator("dialog[open] h2")).to_have_text("YOU WIN!")
        offline("#banner")
        expect(ann.page.locator("dialog[open] h2")).to_have_text("YOU WIN!")
        expect(cem.page.locator("#take")).to_be_visible()  # the queue went on


@pytest.mark.slow
def test_a_lost_robot_is_told_once_and_leads_back(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    serial_node = battle.pid(rf"robot\.serial_node \S*/virtual{ann.robot}/")
    with Paused(psutil.Process(serial_node).ppid()):
        assert "Robot lost" in dialog_of(ann.page)
        ann.page.wait_for_url(f"{battle.web}/")
    expect(ann.page.locator("#availableR")).to_have_text("2 robots are free")


def test_a_page_outlives_a_restart_of_rosbridge(person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    expect(ann.page.locator("#connection-state")).to_contain_text("Online")
    battle.kill(r"python3 -m server\.rosbridge")
    expect(ann.page.locator("#connection-state")).not_to_contain_text("Online")
    expect(ann.page.locator("#connection-state")).to_contain_text("Online")
