"""What gpiod gives to a program that has asked for a line, without the hardware: it keeps what is written to it."""

from gpiod.line import Value


class RecordedRequest:
    """A gpiod.LineRequest of one line; `values` has what was written, in order."""

    def __init__(self) -> None:
        self.values: list[tuple[int, Value]] = []
        self.released = False
        self.gone = False  # while true, writing fails as it does when the chip has been unplugged

    def set_value(self, line: int, value: Value) -> None:
        if self.gone:
            raise OSError(19, "No such device")
        assert not self.released
        self.values.append((line, value))

    def release(self) -> None:
        self.released = True
