"""The camera above the floor: the arena's program as its ustreamer."""

import contextlib
import io
from collections.abc import Callable
from itertools import pairwise

import psutil
import pytest
import requests
from PIL import Image

from laser_bot_battle.apriltag import Detector
from laser_bot_battle.tags import floor_tags
from sim.arena.cameras.pages import OVERHEAD_RATE
from tests.integration.sim.arena import Arena, Hardware
from tests.integration.sim.stream import Stream
from tests.support.floors import BATTLE_FLOOR
from tests.support.polling import LATEST


def tags(jpeg: bytes) -> set[int]:
    picture = Image.open(io.BytesIO(jpeg)).convert("L")
    return {one.number for one in Detector(2).detect(picture.tobytes(), *picture.size)}


def test_its_stream_shows_the_floor_and_the_robots(new_arena: Callable[..., Arena]) -> None:
    arena = new_arena("--overhead-tilt=10")
    with Hardware(arena, "virtual5") as robot:
        robot.line()
        assert psutil.Process(arena.program.process.pid).children() == []  # nobody looks
        with contextlib.closing(Stream(arena, None)) as stream:
            part, later = stream.part(), stream.part()
    assert part and later
    assert part.headers["content-type"] == "image/jpeg"
    assert float(part.headers["x-timestamp"]) < float(later.headers["x-timestamp"])
    assert tags(part.body) == {5, *floor_tags(BATTLE_FLOOR)}


def test_anybody_may_see_the_whole_floor(arena: Arena) -> None:
    answer = requests.get(f"{arena.page}overhead/snapshot", headers={"Accept-Encoding": "gzip"}, timeout=LATEST)
    assert answer.headers["Content-Type"] == "image/jpeg"
    assert "Content-Encoding" not in answer.headers  # it is compressed already
    assert Image.open(io.BytesIO(answer.content)).size == (1280, 720)


def test_a_camera_that_cannot_see_the_whole_floor_is_told(new_arena: Callable[..., Arena]) -> None:
    arena = new_arena("--overhead-lens=-0.3", "--overhead-height=1")
    with contextlib.closing(Stream(arena, None)):
        arena.program.wait_for("does not see the whole floor: hang it higher")


@pytest.mark.slow
def test_there_are_so_many_pictures_a_second(arena: Arena) -> None:
    with contextlib.closing(Stream(arena, None)) as stream:
        stamps = [stream.taken() for _ in range(2 * OVERHEAD_RATE + 1)]
    steps = sorted(later - sooner for sooner, later in pairwise(stamps))
    assert steps[len(steps) // 2] == pytest.approx(1 / OVERHEAD_RATE, rel=0.2)
