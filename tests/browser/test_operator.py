"""The operator's desk in a real browser, on the whole chain: what is pressed there, and what players then see."""

import math
import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.browser.axe import Looks, violations
from tests.browser.people import Person
from tests.support.demo import TOKEN, Demo
from tests.support.journals import KERNEL, from_container, write_journal
from tests.support.player import Eyes, Player
from tests.support.polling import until

AIMED = 0.1  # rad; light is wider
ANSWERS = 3  # to a question each second
PHONES = {"upright": (375, 812), "sideways": (812, 375)}


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=2)
    return demo


def open_desk(chromium: Browser, battle: Demo, width: int = 1280, height: int = 800, token: str = TOKEN) -> Page:
    page = chromium.new_page(viewport={"width": width, "height": height})
    page.goto(f"{battle.web}/operator")
    page.get_by_label("Operator token").fill(token)
    page.get_by_label("Your name").fill("Berta")
    page.get_by_role("button", name="Sign in").click()
    return page


@pytest.fixture
def desk(chromium: Browser, battle: Demo) -> Iterator[Page]:
    """Signed in, with both robots in service and no battle; so it is left."""
    page = open_desk(chromium, battle)
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    expect(page.locator("#robots-rows tr")).to_have_count(2)
    yield page
    for button in page.get_by_role("button", name="Back in service").all():
        button.click()
    expect(page.get_by_role("button", name="Take out of service")).to_have_count(2)
    page.close()
    assert complaints == []


def wait_for_answers(desk: Page) -> None:
    """The desk is redrawn some times."""
    for _ in range(ANSWERS):
        with desk.expect_response("**/operator/api/state"):
            pass


def robot_row(desk: Page, robot: int) -> Locator:
    return desk.locator(f"#robots-rows [data-key='{robot}']")


def say_yes(desk: Page, word: str) -> None:
    desk.locator("dialog[open]").get_by_role("button", name=word).click()


def test_only_the_token_opens_the_desk(chromium: Browser, battle: Demo) -> None:
    page = open_desk(chromium, battle, token="guessed")
    expect(page.get_by_role("alert")).to_contain_text("token")
    expect(page.locator("#battle")).to_have_count(0)
    page.get_by_label("Operator token").fill(TOKEN)
    page.get_by_label("Your name").fill("Berta")
    page.keyboard.press("Enter")
    expect(page.locator("#battle-state")).to_have_text("No battle")
    expect(page.locator(".who")).to_have_text("Berta")
    page.get_by_role("button", name="Sign out").first.click()
    expect(page.get_by_label("Operator token")).to_be_visible()
    page.goto(f"{battle.web}/operator")
    expect(page.get_by_label("Operator token")).to_be_visible()
    page.close()


@pytest.mark.slow
def test_a_session_that_has_ended_leads_back_to_the_login(desk: Page, battle: Demo) -> None:
    desk.context.clear_cookies()
    expect(desk.get_by_label("Operator token")).to_be_visible()
    desk.get_by_label("Operator token").fill(TOKEN)
    desk.keyboard.press("Enter")
    expect(desk.locator("#robots-rows tr")).to_have_count(2)


def test_players_see_pause_more_time_and_abort(desk: Page, person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    status, clock = ann.page.locator("#game-status"), ann.page.locator("#clock strong")
    with Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(status).to_have_text("PLAY!")
        expect(desk.locator("#battle-state")).to_have_text("Battle")
        desk.get_by_role("button", name="Pause").click()
        expect(status).to_have_text("Paused by the operator")
        expect(desk.get_by_role("button", name="Resume")).to_be_focused()
        stands, heading = clock.inner_text(), eyes.robots()[ann.robot]["heading"]
        ann.page.keyboard.down("ArrowRight")
        wait_for_answers(desk)
        assert clock.inner_text() == stands
        assert eyes.robots()[ann.robot]["heading"] == heading
        ann.page.keyboard.up("ArrowRight")

        desk.get_by_role("button", name="Resume").click()
        expect(status).to_have_text("PLAY!")
        ann.page.keyboard.down("ArrowRight")
        until(lambda: eyes.robots()[ann.robot]["heading"] != heading, 10, "the robot turns again")
        ann.page.keyboard.up("ArrowRight")

        desk.get_by_role("button", name="+60 s").click()
        until(lambda: clock.inner_text() > "5:30", 10, "Ann's clock has a minute more")

        desk.get_by_role("button", name="Abort").click()
        say_yes(desk, "Cancel")
        expect(desk.locator("#battle-state")).to_have_text("Battle")
        desk.get_by_role("button", name="Abort").click()
        say_yes(desk, "Abort")
        expect(ann.page.locator("#ready-btn")).to_have_attribute("data-ready", "false")
        expect(desk.locator("#battle-state")).to_have_text("No battle")
        expect(desk.locator("#log-rows li", has_text="Berta").first).to_be_visible()

        desk.get_by_role("button", name="Start now").click()
        expect(status).to_have_text("PLAY!")
        expect(desk.locator("#start small")).to_have_text("A battle is running already.")
        bob.post("signOutUser", data="Bob")


def test_a_rule_counts_at_once_until_it_is_reset(desk: Page, person: Callable[[str], Person], battle: Demo) -> None:
    countdown = desk.get_by_label("Countdown", exact=True)
    countdown.fill("45")
    desk.get_by_label("Hit damage").fill("20")
    wait_for_answers(desk)  # which say otherwise
    expect(countdown).to_have_value("45")
    for name in ("Countdown", "Hit damage"):
        expect(desk.locator("#rules-changed")).to_contain_text(name)
    desk.get_by_role("button", name="Save rules").click()
    expect(desk.locator("#rules-changed")).to_have_text("")
    ann = person("Ann")
    ann.log_in()
    with Player(battle, "Bob") as bob:
        ann.page.locator("#ready-btn").click()
        assert bob.ready() == "OK"
        expect(ann.page.locator("#game-status")).to_contain_text("4")
        expect(desk.locator("#battle-clock")).to_contain_text("0:4")
        desk.get_by_role("button", name="Start now").click()
        expect(ann.page.locator("#game-status")).to_have_text("PLAY!")
        bob.post("signOutUser", data="Bob")
    for name in ("Countdown", "Hit damage"):
        desk.get_by_role("button", name=re.compile(f"Back to .* {name}")).click()
        expect(desk.get_by_role("button", name=re.compile(f"Back to .* {name}"))).to_have_count(0)
    expect(countdown).to_have_value("15")


def test_presets_hold_at_one_press_and_own_ones_are_kept(desk: Page) -> None:
    children, damage = desk.get_by_role("button", name="Children"), desk.get_by_label("Hit damage")
    countdown = desk.get_by_label("Countdown", exact=True)
    standard = countdown.input_value()
    damage.fill("33")
    desk.get_by_label("Name of a new preset").fill("Ours")
    desk.get_by_role("button", name="Save as a preset").click()
    expect(desk.locator("#problem")).to_contain_text("Hit damage")
    desk.get_by_role("button", name="OK", exact=True).click()
    desk.get_by_role("button", name="Save rules").click()
    expect(desk.locator("#rules-changed")).to_have_text("")
    desk.get_by_role("button", name="Save as a preset").click()
    ours = desk.get_by_role("button", name="Ours", exact=True)
    expect(ours).to_have_attribute("aria-pressed", "true")
    countdown.fill("44")
    children.click()
    expect(children).to_have_attribute("aria-pressed", "true")
    expect(ours).to_have_attribute("aria-pressed", "false")
    expect(damage).to_have_value("5")
    expect(countdown).to_have_value("20")
    ours.click()
    expect(damage).to_have_value("33")
    expect(countdown).to_have_value(standard)
    desk.get_by_role("button", name="Remove Ours").click()
    expect(ours).to_have_count(0)


def test_a_refused_rule_changes_nothing_and_says_why(desk: Page) -> None:
    desk.get_by_label("Hit damage").fill("2.5")
    desk.get_by_role("button", name="Save rules").click()
    expect(desk.locator("#problem")).to_contain_text("whole")
    expect(desk.locator("#rules-changed")).to_have_text("Not saved: Hit damage")
    desk.get_by_role("button", name="OK", exact=True).click()
    expect(desk.locator("#problem")).to_be_hidden()


def test_a_rule_of_place_says_so_while_nobody_knows_where_the_robots_are(desk: Page) -> None:
    def unknown(route: Route) -> None:
        response = route.fetch()
        state = response.json()
        state["rules"]["fence"]["idle"] = True
        route.fulfill(response=response, json=state)

    hint = desk.locator(".rule:has(#rule-fence)").get_by_text("Nobody knows where the robots are")
    expect(hint).to_be_hidden()
    desk.route("**/operator/api/state", unknown)
    expect(hint).to_be_visible()
    expect(desk.get_by_text("Nobody knows where the robots are").locator("visible=true")).to_have_count(1)
    desk.unroute("**/operator/api/state")
    expect(hint).to_be_hidden()


def test_the_desk_says_why_battles_wait_and_that_visitors_share_an_address(desk: Page) -> None:
    def troubled(route: Route) -> None:
        response = route.fetch()
        state = response.json()
        state["visitors"]["one_address"] = "10.42.0.1"
        state["game"]["notice"] = "The next battle waits: the server is about to restart."
        route.fulfill(response=response, json=state)

    expect(desk.locator("#one-address")).to_be_hidden()
    desk.route("**/operator/api/state", troubled)
    expect(desk.locator("#one-address")).to_contain_text("come from one address, 10.42.0.1,")
    expect(desk.locator("#battle-hint")).to_have_text("The next battle waits: the server is about to restart.")
    desk.unroute("**/operator/api/state")
    expect(desk.locator("#one-address")).to_be_hidden()


def test_a_message_is_on_the_players_screens_as_it_was_typed(desk: Page, person: Callable[[str], Person]) -> None:
    ann, guest = person("Ann"), person("Guest")
    ann.log_in()
    text = "<b>Last battle</b> at 22:00 & no later"
    desk.locator("#message-text").fill(text)
    desk.keyboard.press("Enter")
    for one in (ann, guest):
        expect(one.page.locator("#message")).to_have_text(text)
    expect(desk.locator("#message-now")).to_have_text(f"Shown now: {text}")
    desk.get_by_role("button", name="Clear").click()
    for one in (ann, guest):
        expect(one.page.locator("#message")).to_be_hidden()


def test_the_player_of_a_robot_out_of_service_waits_and_the_operator_drives_it(
    desk: Page, person: Callable[[str], Person], battle: Demo
) -> None:
    ann = person("Ann")
    ann.log_in()
    row = robot_row(desk, ann.robot)
    with Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        row.get_by_role("button", name="Take out of service").click()
        ann.page.wait_for_url(f"{battle.web}/")
        expect(ann.page.locator("#queue-title")).to_have_text("You are next.")
        expect(desk.locator("#queue-rows")).to_contain_text("Ann")

        row.get_by_role("button", name="Test drive").click()
        expect(desk.locator("#drive-state")).to_contain_text("arrow keys")
        expect(desk.locator("#pad")).to_be_focused()
        drives_and_stands(
            desk, eyes, ann.robot, lambda: desk.keyboard.down("ArrowRight"), lambda: desk.keyboard.up("ArrowRight")
        )
        box = desk.locator("#pad").bounding_box()
        assert box is not None
        desk.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.5 * box["height"])
        drives_and_stands(desk, eyes, ann.robot, desk.mouse.down, desk.mouse.up)
        leave = "window.dispatchEvent(new Event('blur'))"
        drives_and_stands(desk, eyes, ann.robot, desk.mouse.down, lambda: desk.evaluate(leave))
        desk.mouse.up()
        desk.locator("#pad").press("Escape")
        expect(desk.locator("#drive")).to_be_hidden()
        expect(row.get_by_role("button", name="Test drive")).to_be_focused()

        row.get_by_role("button", name="Back in service").click()
        expect(ann.page.locator("#queue-title")).to_have_text(f"Robot {ann.robot} is yours!")
        bob.post("signOutUser", data="Bob")


def drives_and_stands(
    desk: Page, eyes: Eyes, robot: int, press: Callable[[], object], release: Callable[[], object]
) -> None:
    heading = eyes.robots()[robot]["heading"]
    press()
    until(lambda: abs(eyes.robots()[robot]["heading"] - heading) > 0.1, 10, "the robot turns")
    release()
    headings: list[float] = []

    def still() -> bool:
        headings.append(eyes.robots()[robot]["heading"])
        return len(headings) > 40 and len(set(headings[-40:])) == 1

    until(still, 5, "the robot stands")
    expect(desk.locator("#drive .is-held")).to_have_count(0)


@pytest.mark.slow
def test_a_robot_is_given_to_a_bot_and_taken_back(desk: Page, battle: Demo) -> None:
    row = desk.locator("#bots-rows tr").nth(1)
    choice = row.get_by_label("Bot for robot 1")
    choice.select_option("easy")
    expect(row).to_contain_text("Bot1", timeout=15_000)
    expect(desk.locator("#players-rows")).to_contain_text("Bot1")
    choice.select_option("no bot")
    expect(row).not_to_contain_text("Bot1")
    expect(desk.locator("#bots-trouble")).to_be_hidden()


def test_who_is_banned_is_out_until_the_ban_ends(desk: Page, person: Callable[[str], Person], battle: Demo) -> None:
    ann = person("Ann")
    ann.log_in()
    desk.locator("#players-rows [data-key=Ann]").get_by_role("button", name="Ban").click()
    say_yes(desk, "Ban")
    ann.page.wait_for_url(f"{battle.web}/")
    expect(desk.get_by_text("Nobody is signed in.")).to_be_visible()
    expect(desk.locator("#players-title")).to_be_focused()
    ann.page.locator("#username").fill("Ann")
    ann.page.locator("#username").press("Enter")
    expect(ann.page.locator("dialog[open]")).to_contain_text("That does not work")
    ann.page.keyboard.press("Escape")
    desk.get_by_role("button", name="Unban Ann").click()
    expect(desk.get_by_text("Nobody is banned.")).to_be_visible()
    ann.log_in()


def put_face_to_face(battle: Demo) -> None:
    """Other tests have driven the robots about."""
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob, Eyes(battle) as eyes:

        def off(me: int) -> float:
            own, other = eyes.robots()[me], eyes.robots()[1 - me]
            direction = math.atan2(other["y"] - own["y"], other["x"] - own["x"])
            return math.remainder(direction - own["heading"], math.tau)

        def faces(player: Player, looks: list[bool]) -> bool:
            angle = off(player.robot)
            looks.append(abs(angle) < AIMED)
            player.drive(angular=0 if looks[-1] else -1 if angle > 0 else 1)
            return len(looks) > 10 and all(looks[-10:])  # it stands

        for player in (ann, bob):
            until(partial(faces, player, []), 30, "the robot faces the other one")


def test_in_the_light_check_each_robot_flashes_and_the_others_see_it(desk: Page, battle: Demo) -> None:
    battle.play_by(practice=True)
    put_face_to_face(battle)
    check = desk.get_by_role("region", name="Before the evening")
    check.get_by_role("button", name="Light check").click()
    expect(check.get_by_role("status")).to_have_text("All robots flash and see.")
    expect(check.locator("#check-rows tr td[data-field=seen]")).to_have_text(["1", "0"])
    with Player(battle, "Ann") as ann, Player(battle, "Bob") as bob:
        expect(check.get_by_role("button", name="Light check")).to_contain_text("Players could shoot during it")
        battle.play_by(practice=False, countdown=30)
        check.get_by_role("button", name="Light check").click()
        expect(check.get_by_role("button", name="Stop the light check")).to_be_visible()
        assert ann.ready() == bob.ready() == "OK"
        expect(check.get_by_role("button", name="Light check")).to_have_attribute("aria-disabled", "true")
        expect(check.get_by_role("status")).to_contain_text("Only while")
        for one in (ann, bob):
            one.post("signOutUser", data=one.name)


def test_focus_stays_while_the_desk_is_redrawn(desk: Page, battle: Demo) -> None:
    button = robot_row(desk, 1).get_by_role("button", name="Take out of service")
    button.focus()
    with Player(battle, "Bob") as bob:
        expect(desk.locator("#players-rows")).to_contain_text("Bob")
        wait_for_answers(desk)
        expect(button).to_be_focused()
        bob.post("signOutUser", data="Bob")


@pytest.mark.slow
def test_a_lost_server_is_told_and_found_again(desk: Page) -> None:
    desk.context.set_offline(True)
    expect(desk.locator("#connection")).to_contain_text("No connection since")
    desk.get_by_role("button", name="Take out of service").first.click()
    expect(desk.locator("#problem")).to_contain_text("does not answer")
    desk.context.set_offline(False)
    expect(desk.locator("#connection")).to_be_hidden()


@pytest.mark.slow
def test_the_whole_log_can_be_taken_home(desk: Page) -> None:
    with desk.expect_download() as download:
        desk.get_by_role("link", name="log.csv").click()
    assert "Berta" in Path(download.value.path()).read_text()


def test_the_logs_of_all_hosts_are_shown_once_somebody_opens_them(desk: Page, battle: Demo, screenshots: Path) -> None:
    journal = battle.journal
    logs = desk.get_by_role("region", name="Logs of all hosts")
    logs.get_by_text("Show the newest lines").click()
    expect(logs).to_contain_text(f"no journal in {journal} can be read")
    write_journal(journal, "raspberrypi1", [from_container("laserbot-robot", "<b>ready</b>"), KERNEL])
    write_journal(journal, "raspberrypi2", [from_container("laserbot-robot", "ready, too")])
    expect(logs.get_by_role("listitem")).to_have_count(3)
    logs.get_by_label("only warnings").check()
    expect(logs.get_by_role("listitem")).to_have_text([re.compile("raspberrypi1 kernel.*Under-voltage")])
    logs.get_by_label("only warnings").uncheck()
    logs.get_by_role("combobox").select_option("raspberrypi1")
    expect(logs.get_by_role("listitem")).to_contain_text(["Under-voltage", "<b>ready</b>"])
    logs.screenshot(path=screenshots / "operator-logs.png")


def test_everybody_can_use_the_desk_in_german_too(
    chromium: Browser, battle: Demo, screenshots: Path, look: Looks
) -> None:
    desk = chromium.new_page(locale="de-DE")

    def see(what: str) -> None:
        for how in look.at(desk):
            desk.screenshot(path=screenshots / f"desk-{what}-{how}.png", full_page=True)
            look.found[f"{what} {how}"] = violations(desk)
            if desk.evaluate("document.documentElement.scrollWidth > innerWidth"):
                look.found[f"{what} {how}"].append("sticks out")

    desk.goto(f"{battle.web}/operator")
    see("door")
    desk.get_by_label("Kennwort der Spielleitung").fill(TOKEN)
    desk.keyboard.press("Enter")
    expect(desk.locator("#robots-rows tr")).to_have_count(2)
    expect(desk.locator("#battle-state")).to_have_text("Kein Kampf")
    expect(desk.locator("#start")).to_contain_text("zwei Spieler mit Robotern.")
    expect(desk.get_by_label("Schaden je Treffer")).to_be_visible()
    see("empty")
    robot_row(desk, 1).get_by_role("button", name="Außer Betrieb nehmen").click()
    robot_row(desk, 1).get_by_role("button", name="Testfahrt").click()
    expect(desk.locator("#drive-state")).to_contain_text("Steuerkreuz")
    see("drive")
    robot_row(desk, 1).get_by_role("button", name="Wieder in Betrieb").click()
    with Player(battle, "Wolfgang_Amadeus") as wolfgang, Player(battle, "Bob") as bob:
        assert wolfgang.ready() == bob.ready() == "OK"
        expect(desk.locator("#battle-state")).to_have_text("Kampf")
        expect(desk.locator("#battle-hint")).to_contain_text("läuft")
        see("battle")
        desk.locator("#abort").click()
        expect(desk.locator("dialog[open]")).to_contain_text("Den Kampf beenden?")
        see("question")
        say_yes(desk, "Beenden")
        expect(desk.locator("#battle-hint")).to_have_text("Kampf beendet: der Spielleiter hat ihn beendet.")
        for player in (wolfgang, bob):
            player.post("signOutUser", data=player.name)
    desk.close()


def test_sixteen_robots_fit_on_the_screen_of_a_laptop(chromium: Browser, battle: Demo, screenshots: Path) -> None:
    desk = open_desk(chromium, battle, 1366, 768)
    rows = desk.locator("#robots-rows tr")
    expect(rows).to_have_count(2)
    state = desk.request.get(f"{battle.web}/operator/api/state").json()
    robot = {**state["robots"][0], "name": "raspberrypi16", "host": "192.168.111.116", "player": "Wolfgang_Amadeus"}
    state["robots"] = [{**robot, "id": number, "in_service": number != 5} for number in range(1, 17)]
    desk.route("**/operator/api/state", lambda route: route.fulfill(json=state))
    expect(rows).to_have_count(16)
    desk.locator("#robots").evaluate("section => section.scrollIntoView()")
    boxes = rows.evaluate_all("rows => rows.map((row) => row.getBoundingClientRect())")
    assert boxes[0]["top"] >= desk.locator(".desk-top").evaluate("top => top.getBoundingClientRect().bottom")
    assert boxes[-1]["bottom"] <= 768
    assert desk.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert violations(desk) == []
    desk.screenshot(path=screenshots / "desk-laptop.png")
    desk.close()


@pytest.mark.parametrize("way", ["upright", pytest.param("sideways", marks=pytest.mark.slow)])
def test_a_phone_shows_the_desk_without_scrolling_sideways(
    way: str, chromium: Browser, battle: Demo, screenshots: Path
) -> None:
    phone = open_desk(chromium, battle, *PHONES[way])
    with Player(battle, "Wolfgang_Amadeus") as wolfgang:
        expect(phone.locator("#players-rows")).to_contain_text("Wolfgang_Amadeus")
        width, shown = phone.evaluate("[document.documentElement.scrollWidth, innerWidth]")
        assert width == shown
        phone.screenshot(path=screenshots / f"desk-{way}.png", full_page=True)
        wolfgang.post("signOutUser", data="Wolfgang_Amadeus")
    phone.close()
