"""A scene as a picture: what one robot sees."""

import io
import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sim.arena.eyes.bodies import lamps, paint_robot, seen_of
from sim.arena.eyes.colours import BEAM, WHITE
from sim.arena.eyes.glow import BEAM_HEIGHT, Beam, Glow
from sim.arena.eyes.ground import Ground
from sim.arena.eyes.hall import Hall
from sim.arena.eyes.optics import CAMERA_HEIGHT, HEIGHT, WIDTH, Camera, Floats
from sim.arena.eyes.scene import Body, Room, Scene
from sim.arena.eyes.walls import Walls
from sim.arena.geometry import EMITTER_OFFSET

QUALITY = 80  # of the JPEG


class Painter:
    """Paints what is seen in a room. Its textures are painted once, which takes a second."""

    def __init__(self, room: Room) -> None:
        self._hall = Hall(room.ambient)
        self._ground = Ground(room)
        self._walls = Walls(room)
        self._canvas = np.zeros((HEIGHT, WIDTH, 4), np.float32)

    def picture(self, scene: Scene) -> NDArray[np.uint8]:
        """HEIGHT x WIDTH x red, green, blue, and a byte that means nothing."""
        (me,) = (body for body in scene.robots if body.name == scene.eye)
        camera = Camera(me.x, me.y, me.heading)
        others = [seen_of(camera, body) for body in scene.robots if body is not me]
        others.sort(key=lambda seen: seen.depth, reverse=True)
        canvas = self._canvas
        self._hall.paint(canvas, camera)
        self._ground.paint(canvas, camera, others)
        hidden = self._walls.paint(canvas, camera)
        for seen in others:
            hidden = paint_robot(canvas, seen, hidden)
        self._paint_light(canvas, camera, scene, hidden)
        np.clip(canvas, 0, 255, out=canvas)
        return canvas.astype(np.uint8)

    def _paint_light(self, canvas: Floats, camera: Camera, scene: Scene, hidden: Floats) -> None:
        for body in scene.robots:
            if body.name != scene.eye:
                for lamp in lamps(seen_of(camera, body)):
                    lamp.paint(canvas, hidden)
            if body.beam:
                _paint_shot(canvas, camera, body, hidden)
            if body.name == scene.eye and body.lit:
                canvas += (_HIT_COLOUR - canvas) * _HIT

    def jpeg(self, scene: Scene) -> bytes:
        picture = Image.frombuffer("RGBX", (WIDTH, HEIGHT), self.picture(scene), "raw", "RGBX", 0, 1)
        file = io.BytesIO()
        picture.save(file, "JPEG", quality=QUALITY)
        return file.getvalue()


def _paint_shot(canvas: Floats, camera: Camera, body: Body, hidden: Floats) -> None:
    ahead = math.cos(body.heading), math.sin(body.heading)

    def at(distance: float) -> tuple[float, float]:
        return camera.see(body.x + distance * ahead[0], body.y + distance * ahead[1])

    end = at(EMITTER_OFFSET + body.reach)
    Beam(at(EMITTER_OFFSET), end).paint(canvas, hidden)
    Glow(*end, CAMERA_HEIGHT, 0.012, BEAM.mixed(WHITE, 0.4), 1.4).paint(canvas, hidden + 0.03)
    Glow(*at(EMITTER_OFFSET + 0.02), BEAM_HEIGHT, 0.012, BEAM.mixed(WHITE, 0.4), 1.4).paint(canvas, hidden + 0.03)


def _vignette() -> Floats:
    """How much red lies over each pixel when one is hit: most of it at the edges."""
    x, y = np.linspace(-1, 1, WIDTH), np.linspace(-1, 1, HEIGHT)[:, None]
    return (0.12 + 0.75 * np.clip((x**2 + y**2) / 1.6, 0, 1) ** 1.2).astype(np.float32)[..., None]


_HIT = _vignette()
_HIT_COLOUR = np.array([*BEAM, 0], np.float32)
