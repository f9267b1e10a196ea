"""What players have against each other from earlier battles, and who wins battle after battle: pure rules.

Only those who are there have either: whoever leaves is not remembered.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from server.game.people import Name
from server.game.snapshot import Placing


@dataclass(frozen=True, slots=True)
class Winning:
    """Somebody who has won the last battles, alone or with others."""

    name: Name
    battles: int  # in a row


@dataclass(frozen=True, slots=True)
class Grudge:
    """Somebody who has not got even yet."""

    name: Name
    against: Name  # the last one to take them out


def follow(winning: Iterable[Winning], result: Iterable[Placing]) -> tuple[Winning, ...]:
    """Who is winning after a battle with this result."""
    won = {one.name: one.battles for one in winning}
    for placing in result:
        before = won.pop(placing.name, 0)
        if placing.place == 1 and not placing.left:
            won[placing.name] = before + 1
    return tuple(Winning(name, battles) for name, battles in won.items())


def wins(name: str, winning: Iterable[Winning]) -> int:
    """How many battles in a row somebody has won."""
    return next((one.battles for one in winning if one.name == name), 0)


def is_revenge(grudges: Iterable[Grudge], name: str, by: str) -> bool:
    """Whether `by`, who takes `name` out, gets even."""
    return Grudge(by, name) in grudges


def taken_out(grudges: Iterable[Grudge], name: str, by: str) -> tuple[Grudge, ...]:
    """The grudges after `by` has taken `name` out."""
    others = (one for one in grudges if one.name != name and one != Grudge(by, name))
    return (*others, Grudge(name, by))


def forget(
    name: str, winning: Iterable[Winning], grudges: Iterable[Grudge]
) -> tuple[tuple[Winning, ...], tuple[Grudge, ...]]:
    """What is left of both when somebody leaves."""
    return (
        tuple(one for one in winning if one.name != name),
        tuple(one for one in grudges if name not in (one.name, one.against)),
    )
