"""AprilTags of the family tag36h11, by Debian's libapriltag: how a tag looks, and which ones a picture shows.

By ctypes: Debian's Python module for it is compiled for one release of NumPy, and does not load beside another. What is
declared here of the library's structures has been the same in all releases with this soname.
"""

import ctypes
import weakref
from ctypes import POINTER, Structure, c_double, c_float, c_int, c_int32, c_size_t, c_uint8, c_void_p
from functools import cache
from typing import Any, NamedTuple

LIBRARY = "libapriltag.so.3"
TAGS = 587  # of the family: numbers 0 to 586
CELLS = 8  # of a tag's black square, in a row; its white border is one more on each side
MAX_HAMMING = 1  # bits of a tag that are corrected; with more, noise is sometimes taken for a tag

Point = tuple[float, float]


class AprilTagError(Exception):
    """The library cannot be used; the text says what to do."""


class Detection(NamedTuple):
    """A tag in a picture. Points are in pixels from the picture's upper left corner, x to the right and y down."""

    number: int
    corners: tuple[Point, Point, Point, Point]  # of the black square as printed, from the lower left, lower right, on
    margin: float  # between black and white, 0 to 255: how sure it is


class _Image(Structure):
    _fields_ = [("width", c_int32), ("height", c_int32), ("stride", c_int32), ("buffer", c_void_p)]


class _Array(Structure):
    _fields_ = [("element_size", c_size_t), ("size", c_int), ("allocated", c_int), ("data", c_void_p)]


class _Detector(Structure):
    """Its beginning, which is all that is set here."""

    _fields_ = [("threads", c_int), ("decimate", c_float)]


class _Detection(Structure):
    _fields_ = [
        ("family", c_void_p),
        ("id", c_int),
        ("hamming", c_int),
        ("decision_margin", c_float),
        ("homography", c_void_p),
        ("centre", c_double * 2),
        ("corners", c_double * 2 * 4),
    ]


def tag_picture(number: int) -> tuple[tuple[int, ...], ...]:
    """The 10 x 10 cells of a tag from its upper left corner, row by row: 0 is black, 1 white. ValueError for a number
    that no tag has, AprilTagError without the library."""
    if not 0 <= number < TAGS:
        raise ValueError(f"there is no tag {number}: the last one is {TAGS - 1}")
    return _cells(number)


@cache  # also because a picture is never freed: what could free it is in another library
def _cells(number: int) -> tuple[tuple[int, ...], ...]:
    image = _library().apriltag_to_image(_family(), number).contents
    return tuple(
        tuple(int(cell > 127) for cell in ctypes.string_at(image.buffer + row * image.stride, image.width))
        for row in range(image.height)
    )


class Detector:
    """Finds tags in pictures, with one thread. Not for two threads at once. AprilTagError without the library."""

    def __init__(self, decimate: int) -> None:
        """Squares are looked for in every `decimate`-th row and column, and their edges then in all."""
        library = _library()
        self._detector = library.apriltag_detector_create()
        self._detector.contents.threads = 1
        self._detector.contents.decimate = decimate
        family = library.tag36h11_create()
        library.apriltag_detector_add_family_bits(self._detector, family, MAX_HAMMING)
        weakref.finalize(self, _destroy, library, self._detector, family)

    def detect(self, grey: bytes | bytearray, width: int, height: int) -> list[Detection]:
        """The tags in a picture of `height` rows of `width` bytes. Others can use the interpreter meanwhile."""
        if len(grey) != width * height:
            raise ValueError(f"{len(grey)} bytes are no picture of {width} x {height}")
        library = _library()
        pixels = (c_uint8 * len(grey)).from_buffer_copy(grey)
        image = _Image(width, height, width, ctypes.addressof(pixels))
        found = library.apriltag_detector_detect(self._detector, image)
        try:
            addresses = ctypes.cast(found.contents.data, POINTER(POINTER(_Detection)))
            return [_detection(addresses[index].contents) for index in range(found.contents.size)]
        finally:
            library.apriltag_detections_destroy(found)


def _detection(found: _Detection) -> Detection:
    lower_left, lower_right, upper_right, upper_left = ((x, y) for x, y in found.corners)
    return Detection(found.id, (lower_left, lower_right, upper_right, upper_left), found.decision_margin)


def _destroy(library: ctypes.CDLL, detector: Any, family: int) -> None:
    library.apriltag_detector_destroy(detector)
    library.tag36h11_destroy(family)


@cache
def _family() -> int:
    family: int = _library().tag36h11_create()
    return family


@cache
def _library() -> ctypes.CDLL:
    try:
        library = ctypes.CDLL(LIBRARY)
    except OSError:
        raise AprilTagError(f"{LIBRARY} is missing: it comes with Debian's package python3-apriltag") from None
    for name, result, *arguments in (
        ("tag36h11_create", c_void_p),
        ("tag36h11_destroy", None, c_void_p),
        ("apriltag_to_image", POINTER(_Image), c_void_p, c_int),
        ("apriltag_detector_create", POINTER(_Detector)),
        ("apriltag_detector_destroy", None, POINTER(_Detector)),
        ("apriltag_detector_add_family_bits", None, POINTER(_Detector), c_void_p, c_int),
        ("apriltag_detector_detect", POINTER(_Array), POINTER(_Detector), POINTER(_Image)),
        ("apriltag_detections_destroy", None, POINTER(_Array)),
    ):
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
