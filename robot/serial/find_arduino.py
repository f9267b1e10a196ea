"""Which of the serial devices is there."""

import os

from robot.serial import connection


class ArduinoLostError(Exception):
    """There is no working Arduino; the text says why."""


def find_arduino(devices: tuple[str, ...]) -> str:
    """The first device that is there; a URL is taken to be, a board's connection while the board has not ended it."""
    for device in devices:
        if connection.is_inherited(device) and not connection.is_open(device):
            raise ArduinoLostError("the board has closed its connection")
        if "://" in device or os.path.exists(device):
            return device
    raise ArduinoLostError(f"No attached ARDUINO found: looked for {', '.join(devices)}")
