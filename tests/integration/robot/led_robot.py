"""The robot's main program on a Raspberry Pi: `python -m tests.integration.robot.led_robot`.

There is no GPIO in a test. What gpiod is asked for, and what is written to the line, is printed instead.
"""

import sys
import time

import gpiod
from gpiod.line import Value

from robot.id_service_client import main


def say(text: str) -> None:
    """Print a line at once and in one piece: the log goes the same way."""
    print(f"{text}\n", end="", flush=True)


class PrintedRequest:
    def set_value(self, line: int, value: Value) -> None:
        say(f"LED {line} {value.name} at {time.monotonic()}")

    def release(self) -> None:
        say("LED released")


def request_lines(chip: str, consumer: str, config: dict[int, gpiod.LineSettings]) -> PrintedRequest:
    ((line, settings),) = config.items()
    low = "low" if settings.active_low else "high"
    say(f"LED {line} of {chip}: {settings.direction.name}, active {low}, {settings.output_value.name}")
    return PrintedRequest()


if __name__ == "__main__":
    vars(gpiod)["request_lines"] = request_lines
    sys.exit(main())
