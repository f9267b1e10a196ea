"""The result pages in a real browser, on a real server after a played battle."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, expect

from tests.browser.played import Played
from tests.support.polling import until

SIZES = {"desktop": (1280, 800), "phone": (375, 812)}

# how blue the replay is at a place of the floor, in m, 0 to 255
BLUE = """([x, y]) => {
  const canvas = document.querySelector("#replay-floor canvas");
  const scale = canvas.width / 2.1;
  return canvas.getContext("2d").getImageData((x + 0.05) * scale, (1.05 - y) * scale, 1, 1).data[2];
}"""


@pytest.fixture(params=["desktop", pytest.param("phone", marks=pytest.mark.slow)])
def page(request: pytest.FixtureRequest, chromium: Browser) -> Iterator[Page]:
    width, height = SIZES[request.param]
    context = chromium.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))

    def note(message: ConsoleMessage) -> None:
        if message.type == "error" and "ws://" not in message.text:  # there is no rosbridge here
            complaints.append(message.text)

    page.on("console", note)
    yield page
    context.close()
    assert complaints == []


def test_from_the_login_to_a_battle_and_the_leaderboard(played: Played, page: Page, screenshots: Path) -> None:
    width = page.viewport_size["width"] if page.viewport_size else 0

    def look(name: str) -> None:
        page.screenshot(path=screenshots / f"{name}-{width}.png", full_page=True)
        assert page.evaluate("document.documentElement.scrollWidth") <= width, "nothing sticks out"

    page.goto(played.url)
    page.get_by_role("link", name="RESULTS").click()
    battle = page.locator(".battle").last
    expect(battle.locator(".fighters li")).to_have_count(2)
    expect(battle.locator(".won .name")).to_have_text("Jörg")
    expect(battle).to_contain_text("left, Life 20")
    look("results")
    page.get_by_role("link", name="Battle 1").click()
    expect(page.locator("h1")).to_have_text("Battle 1")
    expect(page.locator(".about-battle")).to_contain_text("Battle over: Bob signed out.")
    lines = page.locator(".plot svg .life")
    expect(lines).to_have_count(2)
    heights = [line.bounding_box() for line in lines.all()]
    full = page.locator(".plot svg").bounding_box()
    assert full
    assert [round((box["height"] if box else 0) / full["height"], 1) for box in heights] == [0.0, 0.7], "80 of 100 lost"
    page.get_by_text("What happened", exact=True).click()
    expect(page.locator(".happened tbody tr")).to_have_count(3)
    expect(page.locator(".happened tbody tr").last).to_contain_text("Bobleft20")
    look("results-battle")
    page.get_by_role("link", name="Leaderboard").click()
    expect(page.locator(".ranking tbody tr").first).to_contain_text("Jörg2")
    page.get_by_role("link", name="Today").click()
    expect(page.locator(".ranking tbody tr")).to_have_count(2)
    look("results-leaderboard")
    page.locator("input[name=day]").fill("1999-12-31")
    page.get_by_role("button", name="Show").click()
    expect(page.locator(".none")).to_have_text("Nobody has finished a battle on this day.")


def test_a_battle_is_played_again_on_the_floor(played: Played, page: Page, screenshots: Path) -> None:
    width = page.viewport_size["width"] if page.viewport_size else 0
    page.emulate_media(reduced_motion="reduce")
    page.goto(f"{played.url}/results/1")
    play, slider, clock = (page.locator(f"#replay-{part}") for part in ("play", "time", "clock"))
    expect(play).to_have_text("Play")
    expect(clock).to_contain_text("0:00 of 0:0")
    floor = page.locator("#replay-floor canvas")
    expect(floor).to_have_attribute("aria-label", "The arena seen from above, Jörg 100%, Bob 100%")
    track = page.request.get(f"{played.url}/results/1.json").json()["track"]
    told = {at: (x, y) for at, (x, y, _) in zip(track["times"], track["robots"]["0"], strict=True)}  # of Jörg's robot

    assert track["robots"]["1"][0] == [1.9, 0.9, 180, True], "it is covered"

    def is_at(x: float, y: float) -> bool:
        """Whether the rim of Jörg's robot is seen below there; it has the brightest blue of the floor."""
        return bool(page.evaluate(BLUE, [x, y - 0.0525]) > 150)

    left, right = min(told, key=lambda at: told[at][0]), max(told, key=lambda at: told[at][0])
    assert told[right][0] - told[left][0] > 0.3
    for at, other in ((left, right), (right, left)):
        slider.fill(str(at))
        until(lambda place=told[at]: is_at(*place), 5, "it is there")
        assert not is_at(*told[other])
    slider.press("End")
    expect(floor).to_have_attribute("aria-label", "The arena seen from above, Jörg 100%, Bob out")
    expect(page.locator("#replay-news")).to_contain_text("Bob: left")
    slider.fill("2")
    page.locator(".replay").screenshot(path=screenshots / f"results-replay-{width}.png")
    page.screenshot(path=screenshots / f"results-replay-page-{width}.png", full_page=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "nothing sticks out"
    play.press("Enter")
    expect(play).to_have_text("Pause")
    expect(play).to_have_text("Play")
    assert float(slider.input_value()) == pytest.approx(float(slider.get_attribute("max") or 0)), "played to the end"


def test_the_replay_begins_by_itself_where_motion_is_welcome(played: Played, page: Page) -> None:
    page.goto(f"{played.url}/results/1")
    page.locator("#replay-floor").scroll_into_view_if_needed()
    expect(page.locator("#replay-play")).to_have_text("Pause")
    page.locator("#replay-play").click()
    expect(page.locator("#replay-play")).to_have_text("Play")


def test_without_its_database_a_page_says_so(played: Played, page: Page) -> None:
    elsewhere = played.data.rename(played.data.with_name("elsewhere"))
    played.data.touch()  # a file where the folder was: the server cannot write the database anew meanwhile
    try:
        response = page.request.get(f"{played.url}/results")
        assert response.status == 503
        page.set_content(response.text())
        expect(page.get_by_role("alert")).to_contain_text("The game goes on without it")
    finally:
        played.data.unlink()
        elsewhere.rename(played.data)
