"""Coded light of a robot: who sees it, and whom a whole packet has met. Pure; times are cycles of the robot's AVR."""

from collections.abc import Iterable, Set
from dataclasses import dataclass

CYCLES_PER_SECOND = 16_000_000
PAUSE = 15 * CYCLES_PER_SECOND // 1000  # longer darkness is between packets
MARKS = 15  # of a shot (MilesTag II): the header and 14 bits


@dataclass
class Carrier:
    """The carrier of a robot's emitter. `seen_by`: names of the robots that see this mark, or saw the last one."""

    on: bool = False
    seen_by: frozenset[str] = frozenset()
    _edge: int = 0  # when the last one was
    _marks: int = 0  # of this packet
    _met: frozenset[str] = frozenset()  # who has seen all of them

    def start(self, cycle: int, in_beam: Iterable[str]) -> None:
        """A mark begins, which `in_beam` see."""
        self.seen_by = frozenset(in_beam)
        if self._marks == MARKS or not 0 <= cycle - self._edge <= PAUSE:
            self._marks, self._met = 0, self.seen_by
        self.on, self._edge = True, cycle
        self._met &= self.seen_by

    def end(self, cycle: int) -> Set[str]:
        """The mark ends; returns whom a whole packet has met with it."""
        self.on, self._edge = False, cycle
        self._marks += 1
        return self._met if self._marks == MARKS else frozenset()
