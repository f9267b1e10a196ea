"""Reads the time code of what virtual robots see: docs/protocol-camera.md, "The time code"."""

import io

import numpy as np
from PIL import Image

SQUARE, COLUMNS, ROWS = 16, 16, 2


def time_of(jpeg: bytes) -> int | None:
    """ms of Unix time, modulo 2**24; None if the picture carries no time code, or a spoilt one."""
    grey = np.asarray(Image.open(io.BytesIO(jpeg)).convert("L"))
    squares = grey[SQUARE // 2 : ROWS * SQUARE : SQUARE, SQUARE // 2 : COLUMNS * SQUARE : SQUARE]
    word = np.packbits(squares > 127).tobytes()
    return int.from_bytes(word[:3], "big") if word[3] == (sum(word[:3]) + 0x5A) % 256 else None
