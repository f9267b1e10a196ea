"""A camera above the floor, for tests: where it sees tags, computed the other way round than the tracker does, and its
pictures."""

import io
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from PIL import Image

from laser_bot_battle.apriltag import Detection
from laser_bot_battle.tags import FLOOR_TAG_SIZE, ROBOT_TAG_SIZE, floor_tags, tag_picture

TAG_HEIGHT = 0.11  # m
SIZE = (1280, 720)


class Floor(NamedTuple):
    width: float = 4.0
    height: float = 2.25


FLOOR = Floor()


@dataclass
class OverheadCamera:
    """`x`, `y` and `z` in m from the floor's corner, `tilt` and `turn` in degrees, `focal_length` in halves of the
    picture's width, `bend` of the lens, `noise` in pixels."""

    x: float = 2.0
    y: float = 1.1
    z: float = 2.5
    tilt: float = 0.0
    turn: float = 0.0
    focal_length: float = 0.95
    bend: float = 0.0
    noise: float = 0.0
    print_scale: float = 1.0  # of all tags
    floor: Floor = FLOOR

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(1)

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """n x 2, of points that are n x 3."""
        tilt, turn = math.radians(self.tilt), math.radians(self.turn)
        down = np.diag([1.0, -1.0, -1.0])
        tilted = np.array([[1, 0, 0], [0, math.cos(tilt), -math.sin(tilt)], [0, math.sin(tilt), math.cos(tilt)]])
        turned = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
        seen = (points - [self.x, self.y, self.z]) @ (turned @ tilted @ down).T
        straight = seen[:, :2] / seen[:, 2:] * self.focal_length
        bent = straight * (1 + self.bend * np.sum(straight**2, axis=1, keepdims=True))
        exact = bent * SIZE[0] / 2 + np.array(SIZE) / 2
        return exact + self._random.normal(0, self.noise, exact.shape)

    def tag(self, number: int, pose: tuple[float, float, float], size: float, height: float = 0.0) -> Detection:
        """One that lies there: x, y, heading."""
        x, y, heading = pose
        half = size * self.print_scale / 2
        up = half * np.array([math.cos(heading), math.sin(heading)])
        right = np.array([up[1], -up[0]])
        corners = np.array([x, y]) + np.array([-right - up, right - up, right + up, up - right])
        lower_left, lower_right, upper_right, upper_left = (
            (float(across), float(down)) for across, down in self.pixels(np.column_stack([corners, [height] * 4]))
        )
        return Detection(number, (lower_left, lower_right, upper_right, upper_left), 100.0)

    def floor_tags(self, without: Iterable[int] = ()) -> list[Detection]:
        hidden = set(without)
        places = floor_tags(self.floor)
        return [self.tag(number, places[number], FLOOR_TAG_SIZE) for number in places if number not in hidden]

    def robots(self, poses: Mapping[int, tuple[float, float, float]]) -> list[Detection]:
        return [self.tag(number, pose, ROBOT_TAG_SIZE, TAG_HEIGHT) for number, pose in poses.items()]


def grey_picture(tags: Iterable[Detection], noise: float = 2.0) -> np.ndarray:
    """Of tags on a grey floor, 0 to 255 with so much noise: rows x columns."""
    width, height = SIZE
    canvas = Image.new("L", SIZE, 120)
    for tag in tags:
        cells = Image.fromarray(np.array(tag_picture(tag.number), np.uint8) * 200 + 25).resize(
            (80, 80), Image.Resampling.NEAREST
        )
        to_cells = _perspective(np.array(tag.corners), np.array([(8, 72), (72, 72), (72, 8), (8, 8)]))
        seen = cells.transform(SIZE, Image.Transform.PERSPECTIVE, to_cells, Image.Resampling.BICUBIC)
        inside = Image.new("L", cells.size, 255).transform(SIZE, Image.Transform.PERSPECTIVE, to_cells)
        canvas.paste(seen, mask=inside)
    noisy = np.asarray(canvas) + np.random.default_rng(1).normal(0, noise, (height, width))
    return np.clip(noisy, 0, 255).astype(np.uint8)


def jpeg_of(grey: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(grey).save(buffer, "JPEG", quality=85)
    return buffer.getvalue()


def _perspective(there: np.ndarray, here: np.ndarray) -> tuple[float, ...]:
    """What Pillow needs to find the points `here` for those `there`, four each."""
    rows = []
    for (x, y), (u, v) in zip(there, here, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
    return tuple(np.linalg.solve(np.array(rows), here.ravel()))
