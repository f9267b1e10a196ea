"""Coded light of a robot: who sees it, and whom a whole packet has met. Pure; times are cycles of the robot's AVR."""

from collections.abc import Iterable, Set
from dataclasses import dataclass

CYCLES_PER_SECOND = 16_000_000
PAUSE = 15 * CYCLES_PER_SECOND // 1000  # longer darkness is between packets
MARKS = 15  # of a shot (MilesTag II): the header and 14 bits


@dataclass
class Carrier:
    """The carrier of a robot's emitter. The sets are names of robots: who sees this mark, and who has seen any yet."""

    on: bool = False
    seen_by: frozenset[str] = frozenset()
    watched_by: frozenset[str] = frozenset()
    _met: frozenset[str] = frozenset()  # who has seen all marks of the packet
    _edge: int = 0  # when the last one was
    _marks: int = 0  # of this packet

    def start(self, cycle: int, in_beam: Iterable[str]) -> None:
        """A mark begins, which `in_beam` see."""
        self.seen_by = frozenset(in_beam)
        if self._marks == MARKS or not 0 <= cycle - self._edge <= PAUSE:
            self._marks, self._met, self.watched_by = 0, self.seen_by, frozenset()
        self.on, self._edge = True, cycle
        self._met &= self.seen_by
        self.watched_by |= self.seen_by

    def end(self, cycle: int) -> Set[str]:
        """The mark ends; returns whom a whole packet has met with it."""
        self.on, self._edge = False, cycle
        self._marks += 1
        return self._met if self._marks == MARKS else frozenset()
