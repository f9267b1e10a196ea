"""Under which conditions the camera above the floor works: options of the arena."""

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields


def _condition(default: float, lowest: float, highest: float, text: str) -> float:
    found: float = field(default=default, metadata={"lowest": lowest, "highest": highest, "text": text})
    return found


@dataclass(frozen=True)
class Conditions:
    """Each is best as it is by default."""

    height: float = _condition(2.5, 0.8, 10, "m, of the camera over the floor")
    tilt: float = _condition(0, 0, 15, "degrees that it looks aslant, from the side of y = 0")
    lens: float = _condition(0, -0.3, 0.3, "distortion by its lens, as the first radial term of the pinhole model")
    noise: float = _condition(0, 0, 20, "standard deviation of a pixel's brightness, of 255")
    exposure: float = _condition(0, 0, 0.06, "s in which what moves is blurred")
    shade: float = _condition(0, 0, 0.8, "share of the light that the darkest corner lacks")
    foot: float = _condition(0, 0, 1, "share of the time that a foot covers a quarter of the floor")
    print: float = _condition(1, 0.95, 1.05, "size of the printed tags, of the right one")

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> "Conditions":
        """What the options of add_options() say."""
        return cls(**{one.name: getattr(arguments, f"overhead_{one.name}") for one in fields(cls)})

    @property
    def options(self) -> str:
        """The options that say the same."""
        changed = [one for one in fields(self) if getattr(self, one.name) != one.default]
        return " ".join(f"--overhead-{one.name}={getattr(self, one.name):g}" for one in changed)


def add_options(parser: argparse.ArgumentParser) -> None:
    """`--overhead-height` and so on: the fields of Conditions."""
    group = parser.add_argument_group("the camera above the floor")
    for one in fields(Conditions):
        lowest, highest = one.metadata["lowest"], one.metadata["highest"]
        group.add_argument(
            f"--overhead-{one.name}",
            type=_within(lowest, highest),
            default=one.default,
            metavar="NUMBER",
            help=f"{one.metadata['text']}: {lowest:g} to {highest:g} (default {one.default:g})",
        )


def _within(lowest: float, highest: float) -> Callable[[str], float]:
    def read(text: str) -> float:
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not lowest <= number <= highest:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {lowest:g} to {highest:g}")
        return number

    return read
