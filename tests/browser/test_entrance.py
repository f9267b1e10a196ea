"""The entrance to several arenas in a real browser: one of them has a robot, the other is away."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.axe import Looks, violations
from tests.integration.server.conftest import GameServer
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster


class Hall(NamedTuple):
    entrance: str  # addresses
    arena: str


@pytest.fixture(scope="module")
def hall(temporary_files: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hall]:
    folder = tmp_path_factory.mktemp("hall")
    master, port = RosMaster(folder / "ros"), free_port()
    master.start()
    server = GameServer(master, folder / "data", (), LASERBOT_DOMAIN="*")
    entrance = Program.python(
        "server.entrance",
        env={
            "LASERBOT_BIND": "127.0.0.1",
            "LASERBOT_ENTRANCE_PORT": str(port),
            "LASERBOT_ARENAS": f"red=:{server.url.rpartition(':')[2]} blue=:{free_port()}",
            "LASERBOT_DOMAIN": "*",
            "LASERBOT_DATA": str(folder / "data"),
        },
    )
    try:
        server.wait_until_serving()
        server.robot("robot0")
        entrance.wait_for("the entrance to 2 arenas is at")
        yield Hall(f"http://127.0.0.1:{port}/", server.url)
    finally:
        entrance.stop()
        server.end()
        master.stop()


@pytest.fixture
def page(chromium: Browser) -> Iterator[Page]:
    context = chromium.new_context(locale="en-GB")
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    yield page
    context.close()
    assert complaints == []


def test_everybody_can_use_it(hall: Hall, page: Page, screenshots: Path, look: Looks) -> None:
    page.goto(hall.entrance)
    expect(page.locator(".hall")).to_have_count(2)
    expect(page.locator("#summary")).to_have_text("1 robot is free")
    expect(page.locator(".hall").last).to_contain_text("This arena does not answer.")
    expect(page.get_by_role("link", name="Watch: red")).to_have_attribute("href", f"{hall.arena}/watch")
    expect(page.get_by_role("link", name="Watch: blue")).to_be_hidden()
    for how in look.at(page):
        page.screenshot(path=screenshots / f"entrance-{how}.png", full_page=True)
        look.found[f"entrance {how}"] = violations(page)
        if page.evaluate("document.documentElement.scrollWidth > innerWidth"):
            look.found[f"entrance {how}"].append("sticks out")


def test_who_plays_arrives_in_an_arena_with_the_name_kept(hall: Hall, page: Page) -> None:
    page.goto(hall.entrance)
    page.get_by_label("Your name").fill("Ann Lee")
    page.get_by_role("button", name="Play", exact=True).click()
    page.wait_for_url(f"{hall.arena}/home")
    expect(page.locator(".username").first).to_have_text("Ann Lee")
    page.goto(hall.arena)  # nobody is signed up twice: the wish to play was for once
    expect(page.locator("#restore-title")).to_contain_text("Ann Lee")
    page.goto(hall.entrance)
    expect(page.get_by_label("Your name")).to_have_value("Ann Lee")
    expect(page.locator(".hall").first).to_contain_text("1 player")
    page.get_by_role("button", name="Play here: red").click()
    page.wait_for_url(f"{hall.arena}/home")  # to the same robot, by the same session
    expect(page.locator(".username").first).to_have_text("Ann Lee")


def test_a_name_that_cannot_be_one_goes_nowhere(hall: Hall, page: Page) -> None:
    page.goto(hall.entrance)
    page.get_by_label("Your name").fill("operator")
    page.get_by_role("button", name="Play", exact=True).click()
    expect(page.get_by_role("alert")).to_have_text("This name is reserved. Please choose another one.")
    page.get_by_label("Your name").fill("<b>")
    expect(page.get_by_label("Your name")).to_have_attribute("aria-invalid", "true")
    assert page.url == hall.entrance
