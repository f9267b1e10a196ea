"""Who meets whom in a tournament, by the players' seeds (1 is the best): pure, and the same at every call."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from itertools import zip_longest
from typing import NamedTuple

LEAST, MOST = 4, 64  # players
MOST_IN_GROUP = 8
QUALIFIED = 2  # of each group


class Kind(StrEnum):
    """How a tournament is played."""

    KNOCK_OUT = "knock-out"
    GROUPS = "groups"  # of everybody against everybody; the first two of each go to a knock-out


class Source(NamedTuple):
    """Where a player of a match comes from: "seed" NUMBER, "winner" or "loser" of match NUMBER, or the one at PLACE of
    the group NUMBER ("group")."""

    what: str
    number: int
    place: int = 0


@dataclass(frozen=True, slots=True)
class Match:
    """Two players meet."""

    number: int  # from 1, in the order of play
    round: int  # in a group from 1; else how many players are still in: 2 is the final
    sides: tuple[Source, Source]
    group: int = 0  # 0: none, it is of the knock-out
    third: bool = False  # for the third place


@lru_cache(maxsize=16)
def draw(kind: Kind, players: int, groups: int = 0, third: bool = False) -> tuple[Match, ...]:
    """All matches. Whom a match waits for is known when those before it are decided."""
    if kind is Kind.KNOCK_OUT:
        return tuple(_knock_out([Source("seed", seed) for seed in range(1, players + 1)], 1, third))
    members = group_members(players, groups)
    matches: list[Match] = []
    of_groups = [list(_round_robin(seeds)) for seeds in members]
    for number, rounds in enumerate(zip_longest(*of_groups, fillvalue=()), 1):
        # a match of each group by turns: nobody has to play twice in a row while others have not yet
        for pairs in zip_longest(*rounds):
            for group, pair in enumerate(pairs, 1):
                if pair:
                    one, other = (Source("seed", seed) for seed in pair)
                    matches.append(Match(len(matches) + 1, number, (one, other), group))
    return tuple(matches + _knock_out(_qualified(groups), len(matches) + 1, third))


def group_members(players: int, groups: int) -> list[list[int]]:
    """The seeds of each group, dealt there and back: 1 4 5, 2 3 6."""
    members: list[list[int]] = [[] for _ in range(groups)]
    for seed in range(players):
        turn, place = divmod(seed, groups)
        members[place if turn % 2 == 0 else groups - 1 - place].append(seed + 1)
    return members


def group_numbers(players: int) -> range:
    """Into how many groups so many players can be divided: each has 3 to `MOST_IN_GROUP`."""
    return range(-(-players // MOST_IN_GROUP), players // 3 + 1)


def usual_groups(players: int) -> int:
    """Groups of four, or of a few more."""
    return max(players // 4, group_numbers(players).start)


def seeding(size: int) -> list[int]:
    """The seeds in the order of the bracket, a power of two: the best two meet in the final at the earliest."""
    order = [1]
    while len(order) < size:
        sum_of_pair = 2 * len(order) + 1
        order = [seed for one in order for seed in (one, sum_of_pair - one)]
    return order


def _knock_out(entrants: Sequence[Source], first: int, third: bool) -> list[Match]:
    """`entrants` by their seeds, `first` is the number of the first match. Byes are those of the best."""
    matches: list[Match] = []
    slots = [entrants[seed - 1] if seed <= len(entrants) else None for seed in seeding(_size(len(entrants)))]
    while len(slots) > 1:
        finalists = [slot for slot in slots if slot and slot.what == "winner"]
        if third and len(slots) == 2 and len(finalists) == 2:
            one, other = (Source("loser", finalist.number) for finalist in finalists)
            matches.append(Match(first + len(matches), 4, (one, other), third=True))
        following: list[Source | None] = []
        for higher, lower in zip(slots[::2], slots[1::2], strict=True):
            if higher is None or lower is None:
                following.append(higher or lower)
                continue
            match = Match(first + len(matches), len(slots), (higher, lower))
            matches.append(match)
            following.append(Source("winner", match.number))
        slots = following
    return matches


def _size(players: int) -> int:
    """Of the bracket: the next power of two."""
    return 1 << (players - 1).bit_length()


def _qualified(groups: int) -> list[Source]:
    """In the order of their seeds in the knock-out: the winners first. Nobody meets one of the own group at once."""
    winners = [Source("group", group, 1) for group in range(1, groups + 1)]
    orders = ([Source("group", (place + shift) % groups + 1, 2) for place in range(groups)] for shift in range(groups))
    ways = [winners + seconds for seconds in orders]
    return next((way for way in ways if not _meets_own_group(way)), ways[0])


def _meets_own_group(entrants: Sequence[Source]) -> bool:
    """In the first match of either."""
    pairs = [match.sides for match in _knock_out(entrants, 1, False)]
    return any(one.what == other.what == "group" and one.number == other.number for one, other in pairs)


def _round_robin(seeds: Sequence[int]) -> Iterator[list[tuple[int, int]]]:
    """Each against each, by the circle method: in a round, everybody plays once at most."""
    ring: list[int | None] = [*seeds] + [None] * (len(seeds) % 2)
    half = len(ring) // 2
    for _ in range(len(ring) - 1):
        pairs = zip(ring[:half], reversed(ring[half:]), strict=True)
        yield [(one, other) for one, other in pairs if one is not None and other is not None]
        ring = [ring[0], ring[-1], *ring[1:-1]]
