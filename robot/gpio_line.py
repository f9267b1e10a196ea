"""One output line of the Raspberry Pi's GPIO, through the kernel's character device."""

from typing import Protocol, Self

try:
    import gpiod
    from gpiod.line import Direction, Value  # version 1, which is Debian 12's, has no such module
except ImportError:  # a robot does not need it
    gpiod = None  # type: ignore[assignment]

CHIP = "/dev/gpiochip0"
CONSUMER = "laserbot"  # who has the line, as `gpioinfo` names it


class NoLineError(Exception):
    """The line cannot be used; the text says why."""


class Request(Protocol):
    """What is used of a gpiod.LineRequest."""

    def set_value(self, line: int, value: "Value") -> object: ...

    def release(self) -> object: ...


class GpioLine:
    """A line that is active while its pin is low."""

    def __init__(self, request: Request, number: int) -> None:
        self._request = request
        self._number = number

    @classmethod
    def active_low(cls, number: int, chip: str = CHIP) -> Self:
        """Take the line, active from now on; NoLineError says why that cannot be."""
        if gpiod is None:
            raise NoLineError("the Python library gpiod, version 2, is not installed (Debian 13: python3-libgpiod)")
        settings = gpiod.LineSettings(direction=Direction.OUTPUT, active_low=True, output_value=Value.ACTIVE)
        try:
            return cls(gpiod.request_lines(chip, consumer=CONSUMER, config={number: settings}), number)
        except (OSError, ValueError, NotImplementedError) as error:  # the last two are EINVAL and EOPNOTSUPP
            raise NoLineError(f"line {number} of {chip}: {error}") from None

    def set(self, active: bool) -> None:
        """OSError when the chip is gone."""
        self._request.set_value(self._number, Value.ACTIVE if active else Value.INACTIVE)

    def release(self) -> None:
        """The line is free, and the pin as the kernel leaves it: an input, on a Raspberry Pi."""
        self._request.release()
