"""The floor from above as a picture: what does not move is painted once, and around each robot anew."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from laser_bot_battle.apriltag import TAGS
from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import ROBOT_RADIUS, Wall, wrap
from laser_bot_battle.tags import FLOOR_TAG_SIZE, ROBOT_TAG_SIZE, floor_tags
from sim.arena.cameras.colours import INNER, OUTER, robot_colour
from sim.arena.cameras.ground import distance
from sim.arena.cameras.scene import Body, Scene
from sim.arena.overhead.lens import HEIGHT, WIDTH, Floats, Lens
from sim.arena.overhead.plates import blend, plate, ycc
from sim.arena.overhead.room import Room

QUALITY = 85  # of the JPEG
TAG_HEIGHT = 0.11  # m over the floor, of the tags on robots: what is higher seems farther away
BASE_HEIGHT = 0.05
CELLS = 8  # of a tag's size, which is that of its black square
WALL_HEIGHTS = (0.0, 0.025, 0.05)  # m; low, as a floor needs them whose tags lie behind them
WALL = 0.006  # m, half of a wall's thickness
MARGIN = 0.0875  # m from a floor tag's middle to what must be seen around it
FLOOR, GRID, AROUND = 120.0, 95.0, 60.0  # luminance
CELL, LINE = 0.1, 0.002  # m of the grid, and half of its lines' width
FOOT = np.array([[55], [118], [138]], np.uint8)  # luminance and the two colour differences: leather
FOOT_PERIOD = 5.0  # s from one foot to the next, which covers another quarter
BLURRED = 4  # moments of an exposure that are painted
OUTER_WALLS = 4  # come first
OUTSIDE = 0.25  # m around the floor that a foot covers, too
NOISE_SPARE = 64  # pixels by which the noise is larger than the picture


Moment = tuple[float, float, float]  # x, y, heading


class Painter:
    """The same scenes give the same pictures. To paint what does not move takes a second."""

    def __init__(self, room: Room) -> None:
        """SettingsError if such a camera cannot see the whole floor."""
        floor, self._conditions = room.floor, room.conditions
        tags = floor_tags(floor)
        edges = [(tag.x + east, tag.y + north) for tag in tags.values()
                 for east in (-MARGIN, MARGIN) for north in (-MARGIN, MARGIN)]  # fmt: skip
        self.lens = Lens(room.conditions, (floor.width / 2, floor.height / 2), np.array(edges))
        self._tag = self.lens.at(TAG_HEIGHT)
        self._base = self.lens.at(BASE_HEIGHT)
        self._before: Scene | None = None
        self._chance = np.random.default_rng(1)
        noise = self._chance.normal(0, room.conditions.noise, (HEIGHT + NOISE_SPARE, WIDTH + NOISE_SPARE))
        self._noise = np.rint(noise).astype(np.int16)
        x, y = self.lens.at(0)
        self._gain = _light(x / floor.width, y / floor.height, room.conditions.shade)
        self._feet = [_foot(x, y, floor, east, north) for north in (0, 1) for east in (0, 1)]
        self._still = self._paint_still(room, x, y)

    def picture(self, scene: Scene) -> NDArray[np.uint8]:
        """Luminance and the two colour differences x HEIGHT x WIDTH. Motion is blurred since the scene before."""
        canvas = self._still.copy()
        before = {body.name: body for body in self._before.robots} if self._before else {}
        for body in scene.robots:
            self._paint_robot(canvas, body, self._moments(body, before.get(body.name), scene))
        self._before = scene
        if scene.time % FOOT_PERIOD < self._conditions.foot * FOOT_PERIOD:
            foot = self._feet[int(scene.time / FOOT_PERIOD) % len(self._feet)]
            canvas[:, foot] = FOOT
        if self._conditions.noise:
            down, right = self._chance.integers(0, NOISE_SPARE, 2)
            noisy = self._noise[down : down + HEIGHT, right : right + WIDTH] + canvas[0]
            canvas[0] = np.clip(noisy, 0, 255, out=noisy)
        return canvas

    def jpeg(self, scene: Scene) -> bytes:
        planes = [Image.fromarray(plane) for plane in self.picture(scene)]
        file = io.BytesIO()
        Image.merge("YCbCr", planes).save(file, "JPEG", quality=QUALITY)
        return file.getvalue()

    def _moments(self, body: Body, before: Body | None, scene: Scene) -> list[Moment]:
        """Where a robot was while the picture was taken, and whereto it looked: once if it stood."""
        here = (body.x, body.y, body.heading)
        if self._before is None or before is None or not self._conditions.exposure or scene.time <= self._before.time:
            return [here]
        share = min(1.0, self._conditions.exposure / (scene.time - self._before.time))
        back = (before.x - body.x, before.y - body.y, wrap(before.heading - body.heading))
        if not any(back):
            return [here]
        steps = [share * step / (BLURRED - 1) for step in range(BLURRED)]
        return [(here[0] + back[0] * step, here[1] + back[1] * step, here[2] + back[2] * step) for step in steps]

    def _paint_robot(self, canvas: NDArray[np.uint8], body: Body, moments: list[Moment]) -> None:
        places = np.array([(x, y, height) for x, y, _ in moments for height in (0, TAG_HEIGHT)])
        box = self.lens.box(places, ROBOT_RADIUS + MARGIN / 2)
        gain, ground = self._gain[box], canvas[:, *box].astype(np.float32)
        seen = np.zeros_like(ground)
        colour, pixel = ycc(robot_colour(body.number)), self.lens.pixel
        for x, y, heading in moments:
            pixels = ground.copy()
            across, up = self._base[0][box] - x, self._base[1][box] - y
            away = np.sqrt(across * across + up * up)
            blend(pixels, np.clip((ROBOT_RADIUS - away) / pixel + 0.5, 0, 1), colour, gain)
            if body.id is not None and body.id < TAGS:
                tag = plate(body.id, self._cell(ROBOT_TAG_SIZE), pixel)
                tag.paint(pixels, self._tag[0][box] - x, self._tag[1][box] - y, heading, gain)
            seen += pixels
        canvas[:, *box] = seen / len(moments) + 0.5

    def _paint_still(self, room: Room, x: Floats, y: Floats) -> NDArray[np.uint8]:
        floor, pixel = room.floor, self.lens.pixel
        canvas = np.full((3, HEIGHT, WIDTH), 128, np.float32)
        inside = (x >= 0) & (x <= floor.width) & (y >= 0) & (y <= floor.height)
        away = np.minimum(np.abs(x / CELL - np.rint(x / CELL)), np.abs(y / CELL - np.rint(y / CELL))) * CELL
        grid = np.clip((LINE - away) / pixel + 0.5, 0, 1)
        canvas[0] = np.where(inside, FLOOR + (GRID - FLOOR) * grid, AROUND) * self._gain
        for number, tag in floor_tags(floor).items():
            printed = plate(number, self._cell(FLOOR_TAG_SIZE), pixel)
            box = self.lens.box(np.array([[tag.x, tag.y, 0]]), printed.reach)
            printed.paint(canvas[:, *box], x[box] - tag.x, y[box] - tag.y, tag.heading, self._gain[box])
        for height in WALL_HEIGHTS:
            x, y = self.lens.at(height)
            for number, wall in enumerate(floor.walls):
                colour = ycc((OUTER if number < OUTER_WALLS else INNER).times(0.4 + 8 * height))
                box = self.lens.box(_along(wall, height), 3 * WALL)
                cover = np.clip((WALL - distance(x[box], y[box], wall)) / pixel + 0.5, 0, 1)
                blend(canvas[:, *box], cover, colour, self._gain[box])
        return np.clip(canvas, 0, 255).astype(np.uint8)

    def _cell(self, size: float) -> float:
        """m, of a printed tag."""
        return size * self._conditions.print / CELLS


def _along(wall: Wall, height: float) -> Floats:
    """Places (n x 3) from its one end to the other: the lens bends it."""
    x1, y1, x2, y2 = wall
    share = np.linspace(0, 1, 20)
    return np.column_stack([x1 + share * (x2 - x1), y1 + share * (y2 - y1), np.full(len(share), height)])


def _light(x: Floats, y: Floats, shade: float) -> Floats:
    """How bright each pixel is: all the light is at the upper right; `x` and `y` in sizes of the floor."""
    darkness = np.clip(0.5 - 0.5 * (np.clip(x, -0.5, 1.5) + np.clip(y, -0.5, 1.5) - 1), 0, 1)
    return (1 - shade * darkness).astype(np.float32)


def _foot(x: Floats, y: Floats, floor: Floor, east: int, north: int) -> NDArray[np.bool_]:
    """Which pixels it covers in this quarter of the floor, and beside that."""
    across, up = floor.width / 2 + OUTSIDE, floor.height / 2 + OUTSIDE
    from_middle_x = np.abs(x - floor.width / 2 - (east - 0.5) * across) / (across / 2)
    from_middle_y = np.abs(y - floor.height / 2 - (north - 0.5) * up) / (up / 2)
    return np.asarray(np.maximum(from_middle_x, from_middle_y) <= 1)
