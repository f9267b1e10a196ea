"""A sign of life that costs a health check next to nothing: a file whose time a working program renews."""

import os
from pathlib import Path

from laser_bot_battle.variables import ALIVE_FILE

PERIOD = 1.0  # s between two touches, about


def touch() -> None:
    """The program works. Does nothing unless LASERBOT_ALIVE_FILE names a file."""
    path = ALIVE_FILE.read(os.environ)
    if path:
        Path(path).touch()
