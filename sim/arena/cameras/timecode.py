"""When a picture was taken, in the picture itself, to measure delays up to a screen: docs/protocol-camera.md."""

import numpy as np
from numpy.typing import NDArray

SQUARE = 16  # pixels; a JPEG keeps what is as large as one of its blocks
COLUMNS, ROWS = 16, 2  # squares, from the picture's top left corner
BITS = 24  # of the time: ms, modulo 2**24
SALT = 0x5A  # all black, and all white, is no time code
BLACK, WHITE = 16, 235  # beyond these a JPEG overshoots


def bits_of(taken: float) -> list[int]:
    """The squares of the Unix time `taken` (s), 1 is white: 24 bits of ms and 8 of checksum, each highest bit first."""
    time = round(taken * 1000) % 2**BITS
    word = time << 8 | checksum(time)
    return [word >> place & 1 for place in reversed(range(BITS + 8))]


def checksum(time: int) -> int:
    """The sum of the time's bytes and SALT, modulo 256."""
    return (sum(time.to_bytes(BITS // 8, "big")) + SALT) % 256


def paint_timecode(picture: NDArray[np.uint8], taken: float) -> None:
    """Over the top left corner of a picture (colours x rows x columns)."""
    squares = np.array(bits_of(taken), np.uint8).reshape(ROWS, COLUMNS) * np.uint8(WHITE - BLACK) + np.uint8(BLACK)
    picture[:, : ROWS * SQUARE, : COLUMNS * SQUARE] = np.kron(squares, np.ones((SQUARE, SQUARE), np.uint8))
