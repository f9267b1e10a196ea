"""Tells by the Raspberry Pi's own LED that something in laserbot.txt is wrong: on for a second, off for a second.

    python3 -m cards.led [--boot FOLDER] [--leds FOLDER]

Without mistakes it stays what it is, the kernel's.
"""

import argparse
import sys
from pathlib import Path

from cards.start import own_role, read

NAME = "ACT"  # the green one, which every Raspberry Pi has
PERIOD = 1000  # ms on, and off: much slower than anything that the LED shows otherwise


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    parser.add_argument("--leds", type=Path, default=Path("/sys/class/leds"), help="the kernel's LEDs")
    arguments = parser.parse_args()
    show(arguments.boot, arguments.leds, own_role())
    return 0


def show(boot: Path, leds: Path, role: str) -> None:
    """OSError if the LED cannot do that."""
    _, mistakes = read(boot, role)
    if not mistakes:
        return
    led = leds / NAME
    (led / "trigger").write_text("timer")
    # the kernel makes these with the trigger
    for name in ("delay_on", "delay_off"):
        (led / name).write_text(str(PERIOD))


if __name__ == "__main__":
    sys.exit(main())
