"""How the camera above sees the floor: from pixels to places. Pure.

The floor is projected by a homography, and then bent by the lens: what would be at a distance r from the picture's
middle is at r (1 + bend r^2). Distances in the picture are in halves of its width.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from laser_bot_battle.tags import Rectangle

Floats = NDArray[np.floating[Any]]
Size = tuple[int, int]  # width and height of a picture, in pixels

BENDS = np.linspace(-0.4, 0.2, 7)  # with which the search begins
STEPS = 15  # of the search, at most,
ENOUGH = 1e-6  # share of what is left: one that gains less is the last
STRAIGHTEN = 10  # steps that undo the lens; with 6 of them nothing changes any more
STILL = 1.0  # pixels by which a floor that has not moved seems to, at most
FOCAL_LENGTHS = (0.1, 20.0)  # in halves of the picture's width


@dataclass(frozen=True)
class View:
    """What one camera in one place sees. Points are arrays of n x 2: pixels from the upper left corner, or m on the
    floor."""

    size: Size
    homography: Floats  # 3 x 3, from the floor to the picture that a lens without bend would give
    bend: float
    camera: Floats  # x, y and height of the camera, m

    @classmethod
    def solve(cls, size: Size, tags: Mapping[int, Floats], places: Mapping[int, Floats], height: float) -> Self:
        """By least squares over the corners (4 x 2) of floor tags in the picture, and where they lie.

        `height` of the camera in m must be given: the picture of something flat does not tell it from a longer lens.
        """
        with np.errstate(all="ignore"):  # tags that lie anywhere may end anywhere
            return cls._solve(size, tags, places, height)

    @classmethod
    def _solve(cls, size: Size, tags: Mapping[int, Floats], places: Mapping[int, Floats], height: float) -> Self:
        seen = _normal(np.concatenate([tags[number] for number in tags]), size)
        floor = np.concatenate([places[number] for number in tags])
        middle = floor.mean(axis=0)
        shifted = floor - middle  # what is far from 0, 0 would be uncertain
        guesses = [np.append(_direct(shifted, _straight(seen, bend)), bend) for bend in BENDS]
        best = min(guesses, key=lambda guess: float(np.sum(_misses(guess, shifted, seen) ** 2)))
        best = _least_squares(best, shifted, seen)
        homography = best[:9].reshape(3, 3) @ np.array([[1, 0, -middle[0]], [0, 1, -middle[1]], [0, 0, 1]])
        return cls(size, homography, float(best[9]), _camera(homography, middle, height))

    def places(self, pixels: Floats, height: float = 0.0) -> Floats:
        """What lies there, `height` m above the floor; NaN where the lens shows nothing."""
        with np.errstate(all="ignore"):
            straight = _straight(_normal(pixels, self.size), self.bend)
            on_floor = _project(np.linalg.inv(self.homography), straight)
        over = self.camera[:2]
        places: Floats = over + (on_floor - over) * (1 - height / self.camera[2])
        return places

    def pixels(self, places: Floats) -> Floats:
        """Where in the picture these places on the floor are."""
        pixels: Floats = _bent(_project(self.homography, places), self.bend) * (self.size[0] / 2)
        return pixels + np.array(self.size) / 2


def has_moved(before: View | None, after: View | None, floor: Rectangle) -> bool:
    """Whether the floor is seen elsewhere: each measurement differs a little from the one before."""
    if before is None or after is None:
        return before is not after
    corners = np.array([(x, y) for x in (0, floor.width) for y in (0, floor.height)])
    return bool(np.abs(after.pixels(corners) - before.pixels(corners)).max() > STILL)


def _normal(pixels: Floats, size: Size) -> Floats:
    normal: Floats = (pixels - np.array(size) / 2) / (size[0] / 2)
    return normal


def _project(homography: Floats, points: Floats) -> Floats:
    across = np.column_stack([points, np.ones(len(points))]) @ homography.T
    projected: Floats = across[:, :2] / across[:, 2:]
    return projected


def _bent(straight: Floats, bend: float) -> Floats:
    bent: Floats = straight * (1 + bend * np.sum(straight**2, axis=1, keepdims=True))
    return bent


def _straight(bent: Floats, bend: float) -> Floats:
    """The other way, by Newton's method; NaN beyond the largest distance at which such a lens shows anything."""
    target = np.linalg.norm(bent, axis=1)
    farthest = (-3 * bend) ** -0.5 if bend < 0 else np.inf
    distance = np.minimum(target, 0.99 * farthest)
    for _ in range(STRAIGHTEN):
        step = (distance * (1 + bend * distance**2) - target) / (1 + 3 * bend * distance**2)
        distance = np.clip(distance - step, 0, 0.999 * farthest)
    found = np.abs(distance * (1 + bend * distance**2) - target) < 1e-6
    stretch = np.where(target > 0, distance / np.where(target > 0, target, 1), 1)
    straight: Floats = bent * np.where(found, stretch, np.nan)[:, None]
    return straight


def _direct(floor: Floats, picture: Floats) -> Floats:
    """The homography by the direct linear transform, as 9 numbers whose squares sum to 1."""
    known = np.isfinite(picture).all(axis=1)
    (x, y), (u, v) = floor[known].T, picture[known].T
    one, none = np.ones_like(x), np.zeros_like(x)
    rows = np.concatenate(
        [
            np.column_stack([x, y, one, none, none, none, -u * x, -u * y, -u]),
            np.column_stack([none, none, none, x, y, one, -v * x, -v * y, -v]),
        ]
    )
    solution: Floats = np.linalg.eigh(rows.T @ rows)[1][:, 0]
    return solution


def _misses(parameters: Floats, floor: Floats, seen: Floats) -> Floats:
    """How far each point is from where these parameters put it."""
    return (_bent(_project(parameters[:9].reshape(3, 3), floor), float(parameters[9])) - seen).ravel()


def _least_squares(start: Floats, floor: Floats, seen: Floats) -> Floats:
    """The parameters that leave the least, by Levenberg and Marquardt's method."""
    parameters, damping = start, 1e-3
    misses = _misses(parameters, floor, seen)
    for _ in range(STEPS):
        slopes = np.column_stack(
            [(_misses(parameters + step, floor, seen) - misses) / 1e-7 for step in 1e-7 * np.eye(len(parameters))]
        )
        normal = slopes.T @ slopes
        step = np.linalg.solve(normal + damping * (np.diag(np.diag(normal)) + 1e-12 * np.eye(10)), -slopes.T @ misses)
        tried = _misses(parameters + step, floor, seen)
        gain = misses @ misses - tried @ tried
        if gain > 0:
            parameters, misses, damping = parameters + step, tried, damping / 10
        else:
            damping *= 10
        if 0 <= gain <= ENOUGH * (misses @ misses):
            break
    return parameters


def _camera(homography: Floats, seen: Floats, height: float) -> Floats:
    """Where a camera `height` m above the floor is that sees it so; `seen` is a point of the floor before it."""

    def position(focal_length: float) -> Floats:
        first, second, shift = (np.diag([1 / focal_length, 1 / focal_length, 1]) @ homography).T
        scale = np.sqrt(np.linalg.norm(first) * np.linalg.norm(second))
        scale *= np.sign(homography[2] @ np.append(seen, 1))
        axes = np.column_stack([first, second, np.cross(first, second) / scale]) / scale
        left, _, right = np.linalg.svd(axes)
        place: Floats = -(left @ right).T @ shift / scale
        return place

    shortest, longest = np.log(FOCAL_LENGTHS)
    for _ in range(40):  # the longer the lens, the farther away is the camera
        middle = (shortest + longest) / 2
        if position(np.exp(middle))[2] < height:
            shortest = middle
        else:
            longest = middle
    return np.append(position(np.exp(middle))[:2], height)
