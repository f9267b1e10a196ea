"""A real Chromium (Debian's), driven by Playwright."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

from tests.browser.axe import Looks
from tests.browser.people import Person
from tests.browser.played import Played, played_server
from tests.support.battle import Battle
from tests.support.polling import SLOWNESS
from tests.support.programs import ROOT

Waiting = TypeVar("Waiting", BrowserContext, Page)
# Debian's Chromium without its own windows, each of which would cost as much as the page in it
CHROMIUM = "/usr/bin/chromium-headless-shell"
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-audio-output",  # a clock that eats the sound; PulseAudio would leave its files behind
]


LATEST = 60_000 * SLOWNESS  # ms; what comes at all comes sooner, and nobody waits for it longer than it takes


def patient(make: Callable[..., Waiting]) -> Callable[..., Waiting]:
    """What `make` makes, with as much patience; Playwright has no default for a whole browser."""

    def made(**options: Any) -> Waiting:
        one = make(**options)
        one.set_default_timeout(LATEST)
        return one

    return made


@pytest.fixture(scope="package")
def chromium() -> Iterator[Browser]:
    expect.set_options(timeout=LATEST)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)
        for maker in ("new_context", "new_page"):
            setattr(browser, maker, patient(getattr(browser, maker)))
        yield browser
        browser.close()


@pytest.fixture(autouse=True)
def closes_its_pages(request: pytest.FixtureRequest) -> Iterator[None]:
    """A test that fails leaves no page behind, which would go on playing and looking beside the next test."""
    browser: Browser | None = request.getfixturevalue("chromium") if "chromium" in request.fixturenames else None
    before = list(browser.contexts) if browser else []
    yield
    for context in list(browser.contexts) if browser else []:
        if context not in before:
            context.close()


@pytest.fixture(scope="session")
def screenshots() -> Path:
    """Where the pictures of the pages are kept."""
    folder = ROOT / "build" / "screenshots"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture
def person(chromium: Browser, battle: Battle) -> Iterator[Callable[..., Person]]:
    """Makes people in the module's `battle`; they are gone after the test."""
    people: list[Person] = []

    def make(name: str, **options: Any) -> Person:
        people.append(Person(chromium, battle, name, **options))
        return people[-1]

    yield make
    for one in people:
        one.context.close()
    assert [complaint for one in people for complaint in one.complaints] == []


@pytest.fixture(scope="package")
def played(temporary_files: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Played]:
    with played_server(tmp_path_factory.mktemp("played")) as server:
        yield server


@pytest.fixture(params=[False, pytest.param(True, marks=pytest.mark.slow)], ids=["one look", "all looks"])
def look(request: pytest.FixtureRequest) -> Iterator[Looks]:
    looks = Looks(thorough=request.param)
    yield looks
    assert {state: lines for state, lines in looks.found.items() if lines} == {}
