"""A scene as a picture."""

import io

import numpy as np
from PIL import Image

from sim.arena.eyes.scene import Room, Scene

WIDTH, HEIGHT = 320, 240
QUALITY = 80


class Painter:
    def __init__(self, room: Room) -> None:
        self._room = room

    def jpeg(self, scene: Scene) -> bytes:
        picture = np.full((HEIGHT, WIDTH, 3), 40, np.uint8)
        out = io.BytesIO()
        Image.fromarray(picture).save(out, "JPEG", quality=QUALITY)
        return out.getvalue()
