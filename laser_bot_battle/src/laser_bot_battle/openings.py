"""Connections whose other ends have not said yet what they want: bounded in number and in time. Pure.

Whoever says it at once gets in, however many others are silent: of too many, the slowest gives way.
"""

from collections.abc import Iterator
from typing import Protocol

OPEN_TIMEOUT = 5.0  # s for the other end to say what it wants
OF_ADDRESS = 50  # that one address may have
MOST = 200


class Opening(Protocol):
    """A connection whose other end has not said yet what it wants."""

    address: str

    def cut(self) -> None:
        """End it at once."""


class Openings:
    """Of one server, oldest first."""

    def __init__(self, most: int = MOST, of_address: int = OF_ADDRESS) -> None:
        self._most, self._of_address = most, of_address
        self._began: dict[Opening, float] = {}

    def __len__(self) -> int:
        return len(self._began)

    def __iter__(self) -> Iterator[Opening]:
        return iter(list(self._began))

    def add(self, opening: Opening, now: float, *, is_many: bool = False) -> bool:
        """Whether it may stay; the slowest is cut if there are too many. `is_many`: its address stands for many others,
        as a proxy's does, and has no limit of its own."""
        own = 0 if is_many else sum(other.address == opening.address for other in self._began)
        if len(self._began) >= self._most:
            slowest = next(iter(self._began))
            self.remove(slowest)
            slowest.cut()
        self._began[opening] = now
        return own < self._of_address

    def remove(self, opening: Opening) -> None:
        """It is over, or has said what it wants."""
        self._began.pop(opening, None)

    def cut_older(self, than: float) -> None:
        """Cut those that began before the time `than`."""
        for opening, began in list(self._began.items()):
            if began < than:
                opening.cut()
