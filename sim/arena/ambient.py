"""Light that is no robot's: what a real floor has, shining on all robots. For play and for tests."""

import argparse
from dataclasses import dataclass, fields

US = 16  # cycles of the sources' clocks, which are as fast as the robots'
SOURCE = 15  # number of the remote control among the sources of carriers; the robots have the lowest
PRESS_PERIOD = 1.0  # s between two presses of its key
REPEAT_PERIOD = 0.11  # s from one part of a press to the next

Edges = list[tuple[int, bool]]  # cycles since the start, carrier on


@dataclass(frozen=True)
class Ambient:
    """Which there are: `lamp` flickers with the mains, `sun` never ends, `remote` sends NEC frames at 38 kHz."""

    lamp: bool = False
    sun: bool = False
    remote: bool = False

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> "Ambient":
        """What the options of add_options() say."""
        return cls(**{field.name: getattr(arguments, field.name) for field in fields(cls)})

    @property
    def options(self) -> str:
        """The options that say the same."""
        return " ".join(f"--{field.name}" for field in fields(self) if getattr(self, field.name))


def add_options(parser: argparse.ArgumentParser) -> None:
    """`--lamp`, `--sun` and `--remote`: the fields of Ambient."""
    parser.add_argument("--lamp", action="store_true", help="a lamp flickers 100 times a second")
    parser.add_argument("--sun", action="store_true", help="the sun shines without end")
    parser.add_argument("--remote", action="store_true", help="a key of a remote control is pressed each second")


def key_press(address: int, command: int) -> tuple[Edges, Edges, Edges]:
    """A key of a remote control (NEC): a frame with these two bytes, then twice the mark that it is still down."""
    word = address | (address ^ 0xFF) << 8 | command << 16 | (command ^ 0xFF) << 24
    bits = [1690 if word >> bit & 1 else 560 for bit in range(32)]
    frame = [(9000, 4500), *((560, space) for space in bits), (560, 0)]
    still_down = _edges([(9000, 2250), (560, 0)])
    return _edges(frame), still_down, still_down


def _edges(pulses: list[tuple[int, int]]) -> Edges:
    """`pulses`: us of a mark and of the space after it."""
    edges: Edges = []
    time = 0
    for mark, space in pulses:
        edges += [(time * US, True), ((time + mark) * US, False)]
        time += mark + space
    return edges
