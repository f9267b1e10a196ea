"""Rays of the picture's columns: what they meet, and how far ahead. Pure; arrays have one value for each column."""

from typing import NamedTuple

import numpy as np

from laser_bot_battle.geometry import Wall
from sim.arena.cameras.optics import COLUMNS, FOCAL, NEAR, Camera, Floats

FAR = 100.0  # m; the depth of what is not met


class WallsMet(NamedTuple):
    """The first wall that each column's ray meets."""

    depth: Floats  # m; FAR: none
    along: Floats  # m from the wall's first end
    step: Floats  # m of `along` from one column to the next
    facing: Floats  # 0 to 1: the cosine between the ray and the wall's normal


def meet_walls(camera: Camera, walls: list[Wall]) -> WallsMet:
    if not walls:
        nothing = np.zeros_like(COLUMNS)
        return WallsMet(np.full_like(COLUMNS, FAR), nothing, nothing, nothing)
    ends = [(*camera.see(x1, y1), *camera.see(x2, y2)) for x1, y1, x2, y2 in walls]
    depth1, side1, depth2, side2 = (column[:, None] for column in np.array(ends, np.float32).T)
    deep, wide = depth2 - depth1, side2 - side1
    cross = wide - COLUMNS * deep
    cross[np.abs(cross) < 1e-9] = 1e-9
    share = (COLUMNS * depth1 - side1) / cross
    depth = depth1 + share * deep
    depth[(share < 0) | (share > 1) | (depth < NEAR)] = FAR
    first = depth.argmin(axis=0)
    column = np.arange(len(COLUMNS))
    length = np.hypot(deep, wide)[first, 0]
    step = np.abs((depth1 * wide - side1 * deep)[first, 0] / cross[first, column] ** 2) * length / FOCAL
    facing = np.abs(cross[first, column]) / length / np.sqrt(1 + COLUMNS**2)
    return WallsMet(depth[first, column], share[first, column] * length, step, facing)


class DiscMet(NamedTuple):
    """A round thing in the columns from `first` on; empty arrays if none of them meets it."""

    first: int
    depth: Floats
    angle: Floats  # rad from where the camera looks from to the point that is met, counter-clockwise from above
    cover: Floats  # 0 to 1: how much of the column's width it fills


def meet_disc(depth: float, side: float, radius: float) -> DiscMet:
    """`depth`, `side` of its centre. Nothing is met of one that is not wholly ahead."""
    nothing = DiscMet(0, *(np.empty(0, np.float32),) * 3)
    if depth - radius < NEAR / 2:
        return nothing
    ray = np.sqrt(1 + COLUMNS**2)
    aside = (COLUMNS * depth - side) / ray  # of the centre from the ray
    pixel = depth / FOCAL / ray  # a column's width there
    cover = np.clip((radius - np.abs(aside)) / pixel + 0.5, 0, 1)
    met = np.flatnonzero(cover)
    if not len(met):
        return nothing
    columns = slice(int(met[0]), int(met[-1]) + 1)
    aside, ray = np.clip(aside[columns], -radius, radius), ray[columns]
    to_centre = (depth + COLUMNS[columns] * side) / ray
    distance = to_centre - np.sqrt(radius * radius - aside * aside)
    angle = np.arcsin(aside / radius) - np.arctan(COLUMNS[columns])
    return DiscMet(columns.start, (distance / ray).astype(np.float32), angle.astype(np.float32), cover[columns])
