"""A robot's camera for tests of what its pictures become: a FakeCamera whose pictures can be seen."""

import io
from xmlrpc.client import ServerProxy

from PIL import Image, ImageDraw

from laser_bot_battle.names import camera_parameter
from tests.support.fake_camera import HOST, FakeCamera, part_of


def jpeg(colour: str, size: tuple[int, int] = (640, 480)) -> bytes:
    """A floor of this colour to a horizon, with tiles, and a target in the middle."""
    width, height = size
    image = Image.new("RGB", size, colour)
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 0, width, height // 3), "#34405e")
    for x in range(-3 * width, 4 * width, width // 4):
        draw.line((width // 2, height // 3, x, height), "white", 2)
    for step in range(1, 7):
        y = height // 3 + height * 2 // 3 * step * step // 36
        draw.line((0, y, width, y), "white", 2)
    draw.ellipse((width // 2 - 40, height // 2 - 40, width // 2 + 40, height // 2 + 40), colour)
    saved = io.BytesIO()
    image.save(saved, "JPEG", quality=80)
    return saved.getvalue()


class PictureSource(FakeCamera):
    """Sends pictures of `colour`."""

    def __init__(self, colour: str = "#208040") -> None:
        super().__init__()
        self.paint(colour)

    def paint(self, colour: str) -> None:
        """The pictures are of this colour from now on."""
        picture = jpeg(colour)
        self.part = lambda camera, _: part_of(camera, picture)


def tell(ros_port: int, robot: int, url: str | None) -> None:
    """The robot's camera is there, or, with None, it has none."""
    with ServerProxy(f"http://{HOST}:{ros_port}") as master:
        if url is None:
            master.deleteParam("/test", camera_parameter(robot))
        else:
            master.setParam("/test", camera_parameter(robot), url)
