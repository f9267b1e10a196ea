"""The time code in what robots see."""

import io

import numpy as np
import pytest
from PIL import Image

from sim.arena.ambient import Ambient
from sim.arena.cameras.picture import QUALITY, Painter
from sim.arena.cameras.scene import Body, Room, Scene
from sim.arena.cameras.timecode import bits_of, paint_timecode
from tests.support.floors import BATTLE_FLOOR
from tests.support.timecode import time_of

ME = Body("virtual1", 1, 0.17, 0.17, 0.64, lit=True)


def painter(timecode: bool) -> Painter:
    return Painter(Room(BATTLE_FLOOR.width, BATTLE_FLOOR.height, BATTLE_FLOOR.walls, Ambient(), timecode))


@pytest.mark.parametrize("taken", [1_763_990_000.123, 1_763_990_000.124, 0.0, 2**24 / 1000 - 0.001, 2**24 / 1000])
def test_a_picture_tells_when_it_was_taken(taken: float) -> None:
    jpeg = painter(True).jpeg(Scene("virtual1", 0.0, taken, (ME,)))
    assert time_of(jpeg) == round(taken * 1000) % 2**24


def test_the_documented_example() -> None:
    bits = "".join(map(str, bits_of(0x123456 / 1000)))
    assert f"{int(bits, 2):08x}" == "123456f6"


def test_without_the_option_there_is_none() -> None:
    assert time_of(painter(False).jpeg(Scene("virtual1", 0.0, 1.0, (ME,)))) is None


@pytest.mark.parametrize("grey", [0, 255])
def test_a_screen_that_is_all_dark_or_all_bright_is_no_time_code(grey: int) -> None:
    assert time_of(jpeg_of(np.full((3, 240, 320), grey, np.uint8))) is None


def test_a_spoilt_square_is_noticed() -> None:
    picture = np.zeros((3, 240, 320), np.uint8)
    paint_timecode(picture, 1_763_990_000.0)
    assert time_of(jpeg_of(picture)) is not None
    picture[:, :16, 80:96] = 255 - picture[:, :16, 80:96]
    assert time_of(jpeg_of(picture)) is None


def jpeg_of(picture: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(picture.transpose(1, 2, 0).copy()).save(file, "JPEG", quality=QUALITY)
    return file.getvalue()
