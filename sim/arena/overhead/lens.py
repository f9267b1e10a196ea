"""The camera above the floor: which place each pixel shows, and where in the picture a place is. Lengths in m.

The camera looks at the floor's middle, the picture's upper edge along x. With a tilt it hangs beside the middle, on the
side of y = 0. Its lens is as long as it can be while everything is seen that must be.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from laser_bot_battle.settings import SettingsError
from sim.arena.overhead.conditions import Conditions

Floats = NDArray[np.floating[Any]]  # float32 wherever there are many

WIDTH, HEIGHT = 1280, 720  # pixels
EDGE = 12  # pixels between what must be seen and the picture's edge
FAR = 1e6  # m; where pixels look beyond which the lens shows nothing
STEPS = 8  # of Newton's method; after 6 nothing changes any more


class Lens:
    def __init__(self, conditions: Conditions, middle: tuple[float, float], needed: Floats) -> None:
        """`needed`: places on the floor (n x 2) that must be seen. SettingsError if such a camera cannot see them."""
        self._bend = conditions.lens
        tilt = math.radians(conditions.tilt)
        self._camera = np.array([middle[0], middle[1] - conditions.height * math.tan(tilt), conditions.height])
        self._sine, self._cosine = math.sin(tilt), math.cos(tilt)
        straight = self._straight(np.column_stack([needed, np.zeros(len(needed))]))
        # beyond this distance from the middle, such a lens would show everything a second time
        if -3 * self._bend * float(np.max(np.sum(straight**2, axis=1))) >= 0.95:
            raise SettingsError(
                f"a camera {conditions.height:g} m over the floor with a tilt of {conditions.tilt:g} degrees and a "
                f"lens of {conditions.lens:g} does not see the whole floor: hang it higher"
            )
        reach = np.abs(self._bent(straight)).max(axis=0)
        self._focal = float(min((WIDTH / 2 - EDGE) / reach[0], (HEIGHT / 2 - EDGE) / reach[1]))
        self.pixel = conditions.height / self._cosine / self._focal  # m that a pixel shows in the picture's middle
        self._floor = self._places()

    def at(self, height: float) -> tuple[Floats, Floats]:
        """x and y of what each pixel shows, if that is `height` over the floor: two arrays of HEIGHT x WIDTH."""
        over, share = self._camera.astype(np.float32), np.float32(1 - height / self._camera[2])
        x, y = self._floor
        return over[0] + (x - over[0]) * share, over[1] + (y - over[1]) * share

    def see(self, places: Floats) -> Floats:
        """Where (column, row) places (n x 3) are in the picture, the upper left corner being 0, 0."""
        seen: Floats = self._bent(self._straight(places)) * self._focal + np.array([WIDTH / 2, HEIGHT / 2])
        return seen

    def box(self, places: Floats, margin: float) -> tuple[slice, slice]:
        """The rows and columns of what is around places (n x 3), up to `margin` m from them."""
        reach = np.array([(east, north, 0) for east in (-margin, margin) for north in (-margin, margin)])
        seen = self.see((places[:, None] + reach).reshape(-1, 3))
        left, top = np.maximum(seen.min(axis=0) - 1, 0).astype(int)
        right, bottom = np.maximum(seen.max(axis=0) + 2, 0).astype(int)
        return slice(int(top), int(bottom)), slice(int(left), int(right))

    def _straight(self, places: Floats) -> Floats:
        """As a lens without distortion and with a focal length of 1 shows them."""
        east, north, up = (places - self._camera).T
        depth = north * self._sine - up * self._cosine
        straight: Floats = np.column_stack([east, -north * self._cosine - up * self._sine]) / depth[:, None]
        return straight

    def _bent(self, straight: Floats) -> Floats:
        bent: Floats = straight * (1 + self._bend * np.sum(straight**2, axis=1, keepdims=True))
        return bent

    def _places(self) -> tuple[Floats, Floats]:
        """What each pixel shows on the floor."""
        across = ((np.arange(WIDTH) + 0.5 - WIDTH / 2) / self._focal).astype(np.float32)
        down = ((np.arange(HEIGHT) + 0.5 - HEIGHT / 2) / self._focal).astype(np.float32)[:, None]
        bent = np.sqrt(across**2 + down**2)
        farthest = (-3 * self._bend) ** -0.5 if self._bend < 0 else math.inf
        straight = np.minimum(bent, 0.99 * farthest)
        for _ in range(STEPS):
            miss = straight * (1 + self._bend * straight**2) - bent
            straight = np.minimum(straight - miss / (1 + 3 * self._bend * straight**2), 0.999 * farthest)
        shows = np.abs(straight * (1 + self._bend * straight**2) - bent) < 1e-4
        stretch = straight / np.maximum(bent, 1e-9)
        across, down = across * stretch, down * stretch
        distance = self._camera[2] / (self._cosine + down * self._sine)
        x = self._camera[0] + distance * across
        y = self._camera[1] + distance * (self._sine - down * self._cosine)
        return np.where(shows, x, FAR).astype(np.float32), np.where(shows, y, FAR).astype(np.float32)
