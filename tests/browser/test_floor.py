"""The editor of the floor at the operator's desk."""

import json
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from laser_bot_battle.floor import read_floor
from tests.browser.axe import Looks
from tests.browser.played import Played
from tests.support.demo import TOKEN


@pytest.fixture
def editor(chromium: Browser, played: Played) -> Iterator[Page]:
    """Open at the desk; the floor is as it was afterwards."""
    before = played.floor.read_bytes()
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(f"{played.url}/operator")
    page.get_by_label("Operator token").fill(TOKEN)
    page.get_by_role("button", name="Sign in").click()
    page.get_by_text("Change the floor").click()
    expect(page.locator("#floor-things li")).to_have_count(11)
    yield page
    page.close()
    played.floor.write_bytes(before)
    assert complaints == []


def drag(page: Page, name: str, right: float, up: float) -> None:
    """A thing or handle, by so many m."""
    picture = page.locator("#floor-picture").bounding_box()
    held = page.locator("#floor-picture").get_by_role("button", name=name, exact=True).bounding_box()
    assert picture and held
    metre = picture["width"] / 4.5  # 4 m, and 25 cm on each side
    x, y = held["x"] + held["width"] / 2, held["y"] + held["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right * metre, y - up * metre, steps=4)
    page.mouse.up()


def test_what_is_dragged_and_saved_is_the_floor(editor: Page, played: Played) -> None:
    save = editor.get_by_role("button", name="Save the floor")
    expect(save).to_have_attribute("aria-disabled", "true")
    editor.locator("#floor-picture").scroll_into_view_if_needed()
    drag(editor, "Wall 1", 0.2, 0)
    drag(editor, "Wall 1: second end", 0, 0.3)
    thing = editor.get_by_role("button", name="Hill: the middle", exact=True)
    thing.focus()
    thing.press("Shift+ArrowRight")
    expect(save).to_have_attribute("aria-disabled", "false")
    save.click()
    expect(editor.locator("#toasts")).to_contain_text("saved")
    floor = read_floor(str(played.floor))
    assert floor.walls[4] == pytest.approx((1.7, 0.6, 1.7, 1.9), abs=0.03)
    assert floor.zones[0].x == 2.1


def test_what_is_wrong_is_told_beside_it_and_undone(editor: Page, played: Played) -> None:
    before = played.floor.read_bytes()
    row = editor.locator("#floor-things li").filter(has_text="Start 1")
    row.get_by_role("button").first.click()
    row.get_by_label("x (m)").fill("1.5")
    row.get_by_label("y (m)").fill("1")
    expect(row.locator(".floor-error")).to_contain_text("a robot does not fit")
    expect(editor.locator("#floor-state")).to_have_text("1 thing is wrong.")
    editor.get_by_role("button", name="Save the floor").click(force=True)  # it does nothing
    editor.get_by_role("button", name="Undo").click()
    expect(row.locator(".floor-error")).to_be_hidden()
    assert played.floor.read_bytes() == before


def test_where_the_server_cannot_write_the_file_it_is_downloaded(editor: Page, played: Played) -> None:
    def read_only(route: Route) -> None:
        response = route.fetch()
        route.fulfill(response=response, json=response.json() | {"is_writable": False})

    save, state = editor.get_by_role("button", name="Save the floor"), editor.locator("#floor-state")
    expect(save).to_be_visible()
    editor.route("**/operator/api/floor", read_only)
    editor.get_by_role("button", name="Load again").click()
    expect(editor.locator("#floor-source")).to_contain_text(f"cannot write {played.floor}")
    expect(editor.locator("#floor-source")).to_contain_text("ConfigMap")
    expect(save).to_be_hidden()
    editor.locator("#floor-width").fill("3.9")
    expect(state).to_contain_text("press Download")
    with editor.expect_download() as started:
        editor.get_by_role("button", name="Download").click()
    assert started.value.suggested_filename == played.floor.name
    assert json.loads(started.value.path().read_text())["width"] == 3.9
    expect(state).to_have_text("Nothing has been changed.")


def test_everybody_can_use_it(editor: Page, look: Looks) -> None:
    editor.get_by_role("button", name="+ Wall").click()
    expect(editor.locator("#floor-things li")).to_have_count(12)
    look.all(editor, "the floor's editor")
