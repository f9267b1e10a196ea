"""A real Chromium (Debian's) by Playwright."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

from tests.browser.people import Person
from tests.support.battle import Battle
from tests.support.polling import patience
from tests.support.programs import ROOT

Waiting = TypeVar("Waiting", BrowserContext, Page)
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


def be_patient() -> None:
    """What is expected of a page takes longer on a busy machine."""
    expect.set_options(timeout=20_000 * patience())  # ms


def patient(make: Callable[..., Waiting]) -> Callable[..., Waiting]:
    """What `make` makes, with as much patience; Playwright has no default for a whole browser."""

    def made(**options: Any) -> Waiting:
        one = make(**options)
        one.set_default_timeout(30_000 * patience())  # ms
        return one

    return made


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    be_patient()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", headless=True, args=FLAGS)
        for maker in ("new_context", "new_page"):
            setattr(browser, maker, patient(getattr(browser, maker)))
        yield browser
        browser.close()


@pytest.fixture(autouse=True)
def as_busy_as_now() -> None:
    """Each test has the patience that it needs when it begins."""
    be_patient()


@pytest.fixture(scope="session")
def screenshots() -> Path:
    """Where the pictures of the pages are kept."""
    folder = ROOT / "build" / "screenshots"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture
def person(chromium: Browser, battle: Battle, request: pytest.FixtureRequest) -> Iterator[Callable[..., Person]]:
    """Makes people in the module's `battle`; they are signed out and gone after the test. In a module with EYES they
    look through their robots' cameras."""
    eyes = getattr(request.module, "EYES", False)
    people: list[Person] = []

    def make(name: str, *, policy: bool = True) -> Person:
        people.append(Person(chromium, battle, name, policy=policy, eyes=eyes))
        return people[-1]

    yield make
    for one in people:
        one.context.request.post(f"{battle.web}/signOutUser", form={"data": one.name})
        one.context.close()
    assert [complaint for one in people for complaint in one.complaints] == []
