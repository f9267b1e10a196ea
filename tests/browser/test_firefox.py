"""The demo in Debian's Firefox: the robot's camera and the arena, keys, a phone's size, and the spectators' page."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support.battle import Battle
from tests.support.firefox import Firefox
from tests.support.player import Eyes, Player
from tests.support.polling import until

CAMERA = "document.querySelector('#camera')"
STAGE = "document.querySelector('#stage')"
# Of the page, where nothing else but the arena is; its canvas belongs to another page and tells nothing.
MIDDLE = {"x": 300, "y": 120, "width": 700, "height": 550}
# What a canvas shows, told apart by a number; 0 for one colour only.
PICTURE = """((canvas) => {
  const copy = Object.assign(document.createElement("canvas"), { width: 64, height: 48 });
  const context = copy.getContext("2d");
  context.drawImage(canvas, 0, 0, 64, 48);
  const pixels = new Uint32Array(context.getImageData(0, 0, 64, 48).data.buffer);
  return new Set(pixels).size > 1 ? pixels.reduce((sum, pixel) => (sum * 31 + pixel) >>> 0, 1) : 0;
})"""

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]


@pytest.fixture
def battle() -> Iterator[Battle]:
    with Battle(LASERBOT_COUNTDOWN="3") as running:
        yield running


@pytest.fixture
def firefox(tmp_path: Path) -> Iterator[Firefox]:
    with Firefox(tmp_path) as running:
        yield running


def wait(firefox: Firefox, expression: str, wanted: object, what: str) -> None:
    until(lambda: firefox.ask(expression) == wanted, 30, f"{what}: {expression} is {wanted!r}")


def changes(picture: Callable[[], Any], what: str) -> None:
    """A picture is there, and another one follows it."""
    first = until(picture, 30, f"{what} has a picture")
    until(lambda: picture() not in (0, first), 30, f"{what} has another picture")


def log_in(firefox: Firefox, battle: Battle) -> int:
    """The robot's number; its camera is on the stage."""
    firefox.open(battle.web)
    wait(firefox, "document.querySelector('#availableR').dataset.count", "2", "two robots")
    firefox.ask("document.querySelector('#username').focus()")
    firefox.type("Ann")
    firefox.press("Enter")
    wait(firefox, "document.readyState === 'complete' && location.pathname", "/home", "she is signed in")
    wait(firefox, f"{STAGE}.dataset.view", "camera", "she sees through her robot's camera")
    wait(firefox, f"{CAMERA}.checkVisibility()", True, "the picture is there")
    return int(firefox.ask("document.querySelector('.robotN').innerText").split()[-1])


def test_the_demo_is_played_in_firefox(battle: Battle, firefox: Firefox, screenshots: Path) -> None:
    robot = log_in(firefox, battle)
    with Player(battle, "Bob") as bob, Eyes(battle) as eyes:
        firefox.click("#ready-btn")
        assert bob.ready() == "OK"
        wait(firefox, "document.querySelector('#game-status').innerText", "PLAY!", "the battle")
        start = eyes.robots()[robot]
        firefox.down("ArrowUp")
        firefox.down("ArrowLeft")
        changes(lambda: firefox.ask(f"{PICTURE}({CAMERA})"), "the camera")
        until(lambda: has_moved(start, eyes.robots()[robot]), 30, "the robot obeys the keys")
        wait(firefox, f"{CAMERA}.dataset.level", "fresh", "the picture is not grey")
        (screenshots / "firefox-camera.png").write_bytes(firefox.picture())
        firefox.up("ArrowUp")
        firefox.up("ArrowLeft")

        with battle.pause(r"sim\.arena( |$)"):
            wait(firefox, f"{CAMERA}.dataset.level", "stale", "a picture that stands still")
            age = "document.querySelector('#camera-age').innerText"
            until(lambda: re.fullmatch(r"\d+ s old", firefox.ask(age)), 30, "its age is shown")
            assert "grayscale" in firefox.ask(f"getComputedStyle({CAMERA}).filter")
            (screenshots / "firefox-stale.png").write_bytes(firefox.picture())
        wait(firefox, f"{CAMERA}.dataset.level", "fresh", "it is back")

        firefox.type("v")
        wait(firefox, f"{STAGE}.dataset.view", "arena", "V shows the arena")
        wait(firefox, f"{CAMERA}.checkVisibility()", False, "in place of the camera")
        firefox.down("ArrowLeft")
        changes(lambda: firefox.picture(**MIDDLE), "the arena")
        (screenshots / "firefox-arena.png").write_bytes(firefox.picture())
        firefox.up("ArrowLeft")
        firefox.resize(390, 844)
        firefox.type("v")
        wait(firefox, f"{CAMERA}.checkVisibility()", True, "V shows the camera again")
        wait(firefox, f"Math.round({CAMERA}.getBoundingClientRect().width)", 390, "as wide as a phone")
        (screenshots / "firefox-phone.png").write_bytes(firefox.picture())

        firefox.resize(1280, 800)
        firefox.open(f"{battle.web}/watch")

        def bob_drives() -> bytes:
            bob.drive(1, 1)
            return firefox.picture(**MIDDLE)

        changes(bob_drives, "the spectators' arena")
        (screenshots / "firefox-watch.png").write_bytes(firefox.picture())
        firefox.open("about:blank")
        firefox.open(f"{battle.web}/watch#robot{robot}")
        until(lambda: firefox.ask(f"{PICTURE}({CAMERA})"), 30, "spectators see through the camera")
        (screenshots / "firefox-watch-camera.png").write_bytes(firefox.picture())
    assert firefox.errors == []


def has_moved(before: dict[str, Any], now: dict[str, Any]) -> bool:
    """By more than 5 cm, and turned."""
    distance = abs(now["x"] - before["x"]) + abs(now["y"] - before["y"])
    return bool(distance > 0.05 and abs(now["heading"] - before["heading"]) > 0.1)
