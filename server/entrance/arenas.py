"""All arenas, and which of them a newcomer is led to. Pure: the time is an argument, of a monotonic clock in s.

What arenas say may be old, wrong or a lie. So the entrance counts whom it has just sent, and an arena to which people
are sent and never arrive comes last for a while.
"""

import threading
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from laser_bot_battle.arena_list import ListedArena
from laser_bot_battle.names import Game
from server.entrance.seen import Seen

FRESH = 8.0  # s for which what an arena has said holds; then it is away
ARRIVES_WITHIN = 20.0  # s from being sent to being seen there
LOST = 3  # visitors of different addresses who did not arrive, until an arena comes last
DOUBTED = 60.0  # s for which it does
_MAX_SENT = 200  # of an arena, who are remembered until they arrive


class Choice(NamedTuple):
    """Where a newcomer goes."""

    arena: ListedArena
    waiting: int | None  # who is before the newcomer in the queue; None: a robot is free


class _Sent(NamedTuple):
    name: str
    visitor: str  # a mark of the visitor's address
    at: float


@dataclass
class _Known:
    listed: ListedArena
    place: int  # in the list
    seen: Seen | None = None
    seen_at: float = 0.0
    sent: deque[_Sent] = field(default_factory=lambda: deque(maxlen=_MAX_SENT))
    lost: set[str] = field(default_factory=set)
    doubted_until: float = 0.0

    def state(self, now: float) -> Seen | None:
        """None: it is away."""
        return self.seen if self.seen and now - self.seen_at < FRESH else None

    def forget(self, name: str) -> None:
        """Who is not on the way here any more."""
        for one in [one for one in self.sent if one.name == name]:
            self.sent.remove(one)


class Arenas:
    """Thread-safe."""

    def __init__(self, listed: Sequence[ListedArena]) -> None:
        self._lock = threading.Lock()
        self._arenas = {arena.name: _Known(arena, place) for place, arena in enumerate(listed)}

    def hear(self, name: str, seen: Seen, now: float) -> None:
        """That arena has told how it is."""
        with self._lock:
            arena = self._arenas[name]
            arena.seen, arena.seen_at = seen, now
            for one in list(arena.sent):
                if one.name in seen.names:
                    arena.sent.remove(one)
                    arena.lost.clear()
                    arena.doubted_until = 0.0
                elif now - one.at >= ARRIVES_WITHIN:
                    arena.sent.remove(one)
                    arena.lost.add(one.visitor)
            if len(arena.lost) >= LOST:
                arena.lost.clear()
                arena.doubted_until = now + DOUBTED

    def send(self, name: str, visitor: str, now: float, wanted: str = "") -> Choice | None:
        """Where the newcomer `name` goes: to the arena called `wanted`, if that answers, else to the next free robot of
        any, else to the shortest queue. None: no arena answers. `visitor` stands for the newcomer's address."""
        with self._lock:
            there = [(arena, seen) for arena in self._arenas.values() if (seen := arena.state(now))]
            chosen = [one for one in there if one[0].listed.name == wanted] or there
            if not chosen:
                return None
            for arena in self._arenas.values():
                arena.forget(name)  # who asks again has changed plans
            arena, seen = min(chosen, key=lambda one: _order(one[0], one[1], now))
            seats = _seats(arena, seen)
            arena.sent.append(_Sent(name, visitor, now))
            return Choice(arena.listed, None if seats > 0 else seen.waiting - seats)

    def told(self, now: float) -> list[dict[str, Any]]:
        """What everybody may know, in the order of the list (docs/scale.md)."""
        with self._lock:
            return [_told(arena, arena.state(now)) for arena in self._arenas.values()]


def _seats(arena: _Known, seen: Seen) -> int:
    """Free robots, less those who are on their way; below 0 if they are more."""
    return seen.free - len(arena.sent)


def _order(arena: _Known, seen: Seen, now: float) -> tuple[float, ...]:
    """The smallest is the best."""
    is_doubted = now < arena.doubted_until
    if seen.has_tournament:  # its robots are for the players of its matches
        return is_doubted, 2, arena.place
    seats = _seats(arena, seen)
    if seats > 0:
        return is_doubted, 0, _pace(arena, seen), -seats, arena.place
    return is_doubted, 1, (seen.waiting - seats) / max(1, seen.free + seen.players), arena.place


def _pace(arena: _Known, seen: Seen) -> int:
    """How soon there is a battle with the newcomer."""
    if seen.game is Game.STOPPED:
        return 0 if seen.players or arena.sent else 2  # somebody to play with, or nobody yet
    return 1 if seen.game is Game.COUNTDOWN else 3


def _told(arena: _Known, seen: Seen | None) -> dict[str, Any]:
    told: dict[str, Any] = {"name": arena.listed.name, "address": arena.listed.public, "state": "away"}
    if seen:
        state = "tournament" if seen.has_tournament else seen.game.name.lower()
        told |= {"state": state, "free": seen.free, "players": seen.players, "waiting": seen.waiting}
    return told
