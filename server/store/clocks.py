"""Moments whose age another program can tell, though the wall's clock may be set in between, by days.

The monotonic clock is the same for all programs since the machine has started, and nobody sets it.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

_BOOT_ID = Path("/proc/sys/kernel/random/boot_id")
LONGEST = 3600.0  # s of age that the wall's clock is believed: a machine that was away for longer has lost its players


def _boot_id() -> str:
    try:
        return _BOOT_ID.read_text(encoding="ascii").strip()
    except OSError:
        return ""


@dataclass(frozen=True)
class Clocks:
    """Of this machine."""

    wall: Callable[[], float] = time.time  # Unix time in s
    monotonic: Callable[[], float] = time.monotonic  # s
    boot: str = field(default_factory=_boot_id)  # by which one start of a machine is told from all others; "": unknown

    def offset(self) -> float:
        """What makes a monotonic time a Unix time in s, as the wall's clock is set now."""
        return self.wall() - self.monotonic()

    def mark(self) -> dict[str, Any]:
        """This moment, in JSON's types."""
        return {"unix": self.wall(), "monotonic": self.monotonic(), "boot": self.boot}

    def age(self, mark: Mapping[str, Any]) -> float:
        """How long ago a mark was made, in s: exactly since the same start of the machine, else by the wall's clock,
        0 to LONGEST."""
        if self.boot and mark.get("boot") == self.boot:
            age = self.monotonic() - float(mark["monotonic"])
            if age >= 0:  # else it is the clock of a container of its own
                return age
        return min(max(0.0, self.wall() - float(mark["unix"])), LONGEST)
