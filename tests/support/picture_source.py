"""A robot's camera for tests of what its pictures become: an HTTP server that sends a stream as ustreamer does."""

import io
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Self
from xmlrpc.client import ServerProxy

from PIL import Image, ImageDraw

from laser_bot_battle.names import camera_parameter
from tests.unit.camera.parts import HEAD, part

RATE = 20.0  # pictures a second
HOST = "127.0.0.1"


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


class PictureSource:
    """Sends pictures of `colour` to all who ask for the stream, until it is `silent`."""

    def __init__(self, colour: str = "#208040") -> None:
        self._picture = jpeg(colour)
        self.silent = False
        self.online = True
        self.late = 0.0  # s that a picture is old when it is sent
        self.viewers = 0  # connections that get the stream now
        self._closing = False
        self._server = ThreadingHTTPServer((HOST, 0), self._handler())
        self._server.daemon_threads = True
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.05})

    @property
    def url(self) -> str:
        return f"http://{HOST}:{self._server.server_port}"

    def paint(self, colour: str) -> None:
        """The pictures are of this colour from now on."""
        self._picture = jpeg(colour)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._closing = True
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()

    def _handler(source) -> type[BaseHTTPRequestHandler]:  # noqa: N805 (a handler's self is the request)
        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.wfile.write(HEAD)
                source.viewers += 1
                try:
                    while not source._closing:
                        if not source.silent:
                            self.wfile.write(source._part())
                        time.sleep(1 / RATE)
                except OSError:
                    pass  # the relay has gone
                finally:
                    source.viewers -= 1

            def log_message(self, *_: object) -> None:
                """Nobody reads it."""

        return Handler

    def _part(self) -> bytes:
        online = {} if self.online else {"X_UStreamer_Online": "false"}
        return part(self._picture, X_Timestamp=f"{time.time() - self.late:.6f}", **online)


def tell(ros_port: int, robot: int, url: str | None) -> None:
    """The robot's camera is there, or, with None, it has none."""
    with ServerProxy(f"http://{HOST}:{ros_port}") as master:
        if url is None:
            master.deleteParam("/test", camera_parameter(robot))
        else:
            master.setParam("/test", camera_parameter(robot), url)
