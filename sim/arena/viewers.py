"""The arena's viewers, and how often each gets a state: seldom for onlookers of a crowd, always for drivers."""

import asyncio
from dataclasses import dataclass, field

from laser_bot_battle.openings import OF_ADDRESS

RATE = 25  # states a second
CROWD_RATE = 10  # for those who are thinned
MAX_VIEWERS = 512
CROWD = 64  # viewers who all get RATE

DRIVE, WATCH = "drive", "watch"  # what a viewer may say of itself


@dataclass(eq=False)
class Viewer:
    """One who looks. Until it says that it only watches, it counts as one who needs every state."""

    address: str = ""
    watches: bool = False
    thinned: bool = False


@dataclass
class Viewers:
    """All who look, in the order in which they came."""

    _all: dict[Viewer, None] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self._all)

    def refusal(self, address: str) -> str:
        """Why there is no room for another viewer from there; empty when there is."""
        if sum(viewer.address == address for viewer in self._all) >= OF_ADDRESS:
            return f"{OF_ADDRESS} viewers have your address already"
        return f"{MAX_VIEWERS} look on already" if len(self._all) >= MAX_VIEWERS else ""

    def add(self, viewer: Viewer) -> None:
        self._all[viewer] = None
        self._thin()

    def remove(self, viewer: Viewer) -> None:
        del self._all[viewer]
        self._thin()

    def hear(self, viewer: Viewer, text: str) -> None:
        """A viewer has said `text`; what is not a word of the protocol changes nothing."""
        if text in (DRIVE, WATCH) and viewer.watches != (text == WATCH):
            viewer.watches = text == WATCH
            self._thin()

    def _thin(self) -> None:
        """In a crowd, all who watch are thinned, and all but the first CROWD of the others."""
        is_crowd = len(self._all) > CROWD
        drivers = 0
        for viewer in self._all:
            drivers += not viewer.watches
            viewer.thinned = is_crowd and (viewer.watches or drivers > CROWD)


class Clock:
    """Ticks at RATE for all and at CROWD_RATE for those who are thinned."""

    def __init__(self) -> None:
        self._ticks = 0
        self._every = asyncio.Event()
        self._some = asyncio.Event()

    def tick(self) -> None:
        before, self._ticks = self._ticks, self._ticks + 1
        self._every = _ring(self._every)
        if before * CROWD_RATE // RATE != self._ticks * CROWD_RATE // RATE:
            self._some = _ring(self._some)

    async def wait(self, viewer: Viewer) -> None:
        """Until the next tick for `viewer`."""
        await (self._some if viewer.thinned else self._every).wait()


def _ring(bell: asyncio.Event) -> asyncio.Event:
    """Wake all who wait for `bell`; the bell for the next time."""
    bell.set()
    return asyncio.Event()
