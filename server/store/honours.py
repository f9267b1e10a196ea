"""Who did best on a day, and in what: pure."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from server.store.results import Standing

AIMED = 20  # shots, at least, for somebody's aim to be compared
STREAK = 2  # battles in a row, at least


@dataclass(frozen=True, slots=True)
class Honour:
    kind: str  # "kills": robots taken out; "accuracy": share of the shots that hit; "streak": battles won in a row
    name: str
    value: float


def honours(standings: Sequence[Standing], battles: Iterable[Iterable[tuple[str, bool]]]) -> list[Honour]:
    """Of several who are equal, the one that is ahead on the leaderboard. `battles`, in their order, are the names of
    those who fought, and whether they won."""
    found = []
    killers = [one for one in standings if one.kills]
    if killers:
        best = max(killers, key=lambda one: one.kills or 0)
        found.append(Honour("kills", best.name, best.kills or 0))
    aimers = [one for one in standings if one.accuracy is not None and (one.shots or 0) >= AIMED]
    if aimers:
        best = max(aimers, key=lambda one: one.accuracy or 0.0)
        found.append(Honour("accuracy", best.name, best.accuracy or 0.0))
    longest = _longest_streaks(battles)
    streaks = [(longest.get(one.name, 0), one.name) for one in standings]
    length, name = max(streaks, key=lambda streak: streak[0], default=(0, ""))
    if length >= STREAK:
        found.append(Honour("streak", name, length))
    return found


def _longest_streaks(battles: Iterable[Iterable[tuple[str, bool]]]) -> dict[str, int]:
    running: dict[str, int] = {}
    longest: dict[str, int] = {}
    for battle in battles:
        for name, won in battle:
            running[name] = running.get(name, 0) + 1 if won else 0
            longest[name] = max(longest.get(name, 0), running[name])
    return longest
