"""The robot's status LED: tells who stands beside the robot whether it starts, works, or lacks something.

At BCM GPIO 18 if nothing else is set, lit while the pin is low (manual 4.5.1: the LED of the entrypoint).
"""

import logging
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from enum import Enum

from robot.gpio_line import GpioLine, NoLineError

TICK = 0.02  # s; nobody sees that a change is this late
END_TIMEOUT = 1.0  # s

_log = logging.getLogger(__name__)


class State(Enum):
    """What the LED tells and how: for how many s it is dark, then for how many s it is lit, and so on."""

    STARTING = (0.0, 1.0)  # has had no ID yet
    WORKING = (0.5, 0.5)  # has an ID and an Arduino, and the server answers
    FAILING = (0.1, 0.1)  # lacks one of these, and tries again


def lit(state: State, seconds: float) -> bool:
    """Whether the LED is lit `seconds` after the state began."""
    dark, bright = state.value
    return seconds % (dark + bright) >= dark


@dataclass
class Indication:
    """What the LED is to tell: written by the robot's supervisor, read by the LED's thread."""

    state: State = State.STARTING


class LedThread(threading.Thread):
    """Shows an indication on a line that is lit already; a context manager that leaves the LED dark.

    Nobody else uses the line, so nothing ever waits for the LED.
    """

    def __init__(self, indication: Indication, line: GpioLine) -> None:
        super().__init__(name="status LED", daemon=True)
        self._indication = indication
        self._line = line
        self._lit = True
        self._shown = indication.state
        self._since = 0.0  # when that began; no matter for the first, which is lit for ever
        self._end = threading.Event()

    def __enter__(self) -> "LedThread":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._end.set()
        self.join(END_TIMEOUT)

    def run(self) -> None:
        try:
            while not self._end.wait(TICK):
                self.update(time.monotonic())
            self._light(False)
        except OSError as error:
            _log.warning("the status LED can no longer be set: %s", error)
        finally:
            self._line.release()

    def update(self, now: float) -> None:
        """Show what is to be seen at `now`, s of a steady clock; OSError when the line is gone."""
        if self._indication.state is not self._shown:
            self._shown, self._since = self._indication.state, now
        self._light(lit(self._shown, now - self._since))

    def _light(self, lit: bool) -> None:
        if lit != self._lit:
            self._line.set(lit)
            self._lit = lit


@contextmanager
def status_led(number: int | None) -> Iterator[Indication]:
    """What the LED at this GPIO tells inside the block. The LED is lit at once, and dark in the end.

    None: the robot has no LED. The same when the GPIO cannot be used; the log then says why.
    """
    line = None
    if number is not None:
        try:
            line = GpioLine.active_low(number)
        except NoLineError as error:
            _log.info("no status LED: %s", error)
    indication = Indication()
    with LedThread(indication, line) if line else nullcontext():
        yield indication
