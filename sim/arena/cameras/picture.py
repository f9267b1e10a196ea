"""A scene as a picture: what one robot sees."""

import io
import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from laser_bot_battle.geometry import EMITTER_OFFSET
from sim.arena.ambient import PRESS_PERIOD
from sim.arena.cameras.backdrop import Backdrop
from sim.arena.cameras.bodies import lamps, paint_robot, seen_of
from sim.arena.cameras.colours import BEAM, WHITE
from sim.arena.cameras.glow import BEAM_HEIGHT, Beam, Glow
from sim.arena.cameras.ground import Ground
from sim.arena.cameras.optics import CAMERA_HEIGHT, HEIGHT, WIDTH, Camera, Floats
from sim.arena.cameras.scene import Body, Room, Scene
from sim.arena.cameras.timecode import paint_timecode
from sim.arena.cameras.walls import Walls

QUALITY = 80  # of the JPEG
ONLOOKER, ONLOOKER_HEIGHT = 0.8, 0.55  # m from the floor, and over it: where the remote control is
PRESS = 0.3  # s that its light is shown


class Painter:
    """Paints what is seen in a room. Its textures are painted once, which takes a second."""

    def __init__(self, room: Room) -> None:
        self._backdrop = Backdrop(room.ambient)
        self._ground = Ground(room)
        self._walls = Walls(room)
        self._room = room
        self._canvas = np.zeros((3, HEIGHT, WIDTH), np.float32)
        self._newest: dict[str, tuple[object, bytes]] = {}  # of each eye: what it saw, and the JPEG

    def picture(self, scene: Scene) -> NDArray[np.uint8]:
        """Red, green and blue x HEIGHT x WIDTH."""
        (me,) = (body for body in scene.robots if body.name == scene.eye)
        camera = Camera(me.x, me.y, me.heading)
        others = [seen_of(camera, body) for body in scene.robots if body is not me]
        others.sort(key=lambda seen: seen.depth, reverse=True)
        canvas = self._canvas
        self._backdrop.paint(canvas, camera)
        self._ground.paint(canvas, camera, others)
        hidden = self._walls.paint(canvas, camera)
        for seen in others:
            nearer = paint_robot(canvas, seen, hidden)
            for lamp in lamps(seen):
                lamp.paint(canvas, hidden)  # its robot does not hide it
            hidden = nearer
        self._paint_light(canvas, camera, scene, hidden)
        np.clip(canvas, 0, 255, out=canvas)
        picture = canvas.astype(np.uint8)
        if self._room.timecode:
            paint_timecode(picture, scene.taken)
        return picture

    def _paint_light(self, canvas: Floats, camera: Camera, scene: Scene, hidden: Floats) -> None:
        if self._remote_shines(scene):
            place = camera.see(self._room.width / 2, -ONLOOKER)
            Glow(*place, ONLOOKER_HEIGHT, 0.05, BEAM.mixed(WHITE, 0.2), 1.5).paint(canvas, hidden)
        for body in scene.robots:
            if body.beam:
                _paint_shot(canvas, camera, body, hidden)
            if body.name == scene.eye and body.lit:
                canvas += (BEAM.light - canvas) * _HIT

    def _remote_shines(self, scene: Scene) -> bool:
        return self._room.ambient.remote and scene.time % PRESS_PERIOD < PRESS

    def jpeg(self, scene: Scene) -> bytes:
        """The picture, painted only if the eye sees something else than before."""
        seen = (scene.robots, self._remote_shines(scene), scene.taken if self._room.timecode else None)
        before, jpeg = self._newest.get(scene.eye, (None, b""))
        if seen != before:
            planes = [Image.fromarray(plane) for plane in self.picture(scene)]
            file = io.BytesIO()
            Image.merge("RGB", planes).save(file, "JPEG", quality=QUALITY)
            jpeg = file.getvalue()
            self._newest[scene.eye] = seen, jpeg
        return jpeg


def _paint_shot(canvas: Floats, camera: Camera, body: Body, hidden: Floats) -> None:
    ahead = math.cos(body.heading), math.sin(body.heading)

    def at(distance: float) -> tuple[float, float]:
        return camera.see(body.x + distance * ahead[0], body.y + distance * ahead[1])

    end = at(EMITTER_OFFSET + body.reach)
    Beam(at(EMITTER_OFFSET), end).paint(canvas, hidden)
    Glow(*end, CAMERA_HEIGHT, 0.01, BEAM.mixed(WHITE, 0.3), 1.1).paint(canvas, hidden + 0.03)
    Glow(*at(EMITTER_OFFSET + 0.02), BEAM_HEIGHT, 0.01, BEAM.mixed(WHITE, 0.3), 1.1).paint(canvas, hidden + 0.03)


def _vignette() -> Floats:
    """How much red lies over each pixel when one is hit: most of it at the edges."""
    x, y = np.linspace(-1, 1, WIDTH), np.linspace(-1, 1, HEIGHT)[:, None]
    return (0.08 + 0.62 * np.clip((x**2 + y**2) / 1.7, 0, 1) ** 1.5).astype(np.float32)


_HIT = _vignette()
