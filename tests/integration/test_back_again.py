"""In the middle of a battle the web server is killed, or the ROS master hangs: the drivers do not notice."""

import math
import time
from collections.abc import Iterator

import pytest

from server.rosbridge.gate import REFEREE_SILENCE
from tests.support.demo import Demo
from tests.support.play import PLAYING, keep_turning, start
from tests.support.player import Eyes, Player
from tests.support.polling import until

BACK = 10.0  # s; 1.6 on a quiet machine
WEB = r"python3 -m server\.main"


pytestmark = pytest.mark.slow  # the time is real
Fight = tuple[Demo, Player, Player, Eyes]


@pytest.fixture
def fight(demo: Demo) -> Iterator[Fight]:
    """A battle that has just begun, its two players, and where their robots are."""
    demo.play_by(countdown=1)
    with (
        Player(demo, "ann") as ann,
        Player(demo, "bob") as bob,
        Eyes(demo) as eyes,
    ):
        start(ann, bob)
        yield demo, ann, bob, eyes


def test_who_drives_while_the_web_server_is_killed_and_comes_back_does_not_notice(fight: Fight) -> None:
    battle, ann, bob, eyes = fight
    begun = ann.look()
    with keep_turning(ann):
        until(lambda: turning(eyes, ann.robot), 5, "the robot turns")
        battle.kill(WEB)
        killed = time.monotonic()
        stood = 0
        while not is_signed_in(ann):
            stood += not turning(eyes, ann.robot)
        until(lambda: ann.look()["time_left"] < begun["time_left"] - 0.5, 10, "the referee speaks again")
        silent = time.monotonic() - killed
        stood += not turning(eyes, ann.robot)
    after = ann.look()
    assert stood == 0 or silent > REFEREE_SILENCE - 0.5, "after so long on a busy machine all robots are to stop"
    assert silent < BACK
    assert (after["game"], after["battle"]) == (PLAYING, begun["battle"])
    assert is_signed_in(bob)


def turning(eyes: Eyes, robot: int) -> bool:
    """Whether the robot turns within the next 0.3 s of a quiet machine."""
    heading = eyes.robots()[robot]["heading"]
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        if abs(math.remainder(eyes.robots()[robot]["heading"] - heading, math.tau)) > 0.01:
            return True
    return False


def is_signed_in(player: Player) -> bool:
    try:
        return bool(player.http.get(f"{player.battle.web}/session", timeout=1).json()["status"] == "OK")
    except OSError:
        return False
