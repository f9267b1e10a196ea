"""The camera above the floor: its newest picture, and what is wrong with it. For the event loop's thread."""

import asyncio
import io
import time
from functools import partial
from typing import NoReturn

from PIL import Image

from laser_bot_battle.apriltag import Detection, Detector
from laser_bot_battle.names import ABOVE
from server.camera.clock import ClockOffset
from server.camera.multipart import Part, StreamError
from server.camera.picture import Picture, dated, picture_of
from server.camera.stream import Address, follow
from server.overhead.view import Size

RETRY = 1.0  # s from one attempt to connect to the next
MOST_PIXELS = 4_000_000  # of a picture; twice as many take a second to look through
LEAST_SIDE = 64  # pixels; libapriltag crashes on some pictures of only a few rows or columns
FINE = 900  # pixels of a picture's width; in a larger one tags are large enough to skip every second row


class Eye:
    """Follows the camera's stream for ever, and connects again when that ends."""

    def __init__(self, address: Address) -> None:
        self._address = address
        self.url = address.url
        self._come = asyncio.Event()
        self._picture: Picture | None = None
        self.pictures = 0  # that have come
        self.trouble = ""
        """why there are no pictures"""

    async def run(self) -> NoReturn:
        while True:
            began = time.monotonic()
            try:
                await follow(self._address, partial(self._received, ClockOffset()))
            except StreamError as error:
                self.trouble = str(error)
            await asyncio.sleep(began + RETRY - time.monotonic())

    async def newest(self) -> Picture:
        """The next picture that comes, or the last one that came meanwhile."""
        await self._come.wait()
        self._come.clear()
        assert self._picture
        return self._picture

    def _received(self, offset: ClockOffset, part: Part) -> None:
        now = time.time()
        self.pictures += 1
        picture = picture_of(dated(part, now), ABOVE, self.pictures, offset, now)
        if not picture.online:
            self.trouble = "the camera is away from its ustreamer: look at its cable"
            return
        self.trouble, self._picture = "", picture
        self._come.set()


class PictureError(Exception):
    """It cannot be looked at; the text says why."""


class Looker:
    """Finds the tags in pictures."""

    def __init__(self) -> None:
        """AprilTagError without its library."""
        self._detectors = {decimate: Detector(decimate) for decimate in (1, 2)}

    def tags(self, jpeg: bytes) -> tuple[list[Detection], Size]:
        """And the picture's size. Takes a while, but not the interpreter. PictureError."""
        try:
            with Image.open(io.BytesIO(jpeg), formats=["JPEG"]) as picture:
                width, height = picture.size
                if width * height > MOST_PIXELS:
                    raise PictureError(f"its pictures of {width} x {height} are too large: 1280 x 720 is enough")
                if min(width, height) < LEAST_SIDE:
                    raise PictureError(f"its pictures of {width} x {height} are too small: 1280 x 720 is right")
                picture.draft("L", picture.size)  # its colours need not be computed
                grey = picture.convert("L").tobytes()
        except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
            raise PictureError(f"it sends broken pictures ({error})") from None
        return self._detectors[1 if width < FINE else 2].detect(grey, width, height), (width, height)
