"""Which of the serial devices is there."""

import os


class ArduinoLostError(Exception):
    """There is no working Arduino; the text says why."""


def find_arduino(devices: tuple[str, ...]) -> str:
    """The first device that is there; a URL is taken to be."""
    for device in devices:
        if "://" in device or os.path.exists(device):
            return device
    raise ArduinoLostError(f"No attached ARDUINO found: looked for {', '.join(devices)}")
