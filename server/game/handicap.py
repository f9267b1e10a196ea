"""Who takes less damage, since nothing but battles were lost of late: pure rules."""

from collections.abc import Iterable
from dataclasses import dataclass

from laser_bot_battle.names import is_bot
from server.game.people import Name
from server.game.snapshot import Placing

IN_A_ROW = 3  # lost battles
REMEMBERED = 1000  # people, those who have lost last


@dataclass(frozen=True, slots=True)
class Losing:
    """Somebody who has won none of the last battles."""

    name: Name
    battles: int  # in a row


def follow(losing: Iterable[Losing], result: Iterable[Placing]) -> tuple[Losing, ...]:
    """Who is losing after a battle with this result. To leave it is neither to win nor to lose: else a handicap could
    be had without fighting. Bots have none."""
    lost = {one.name: one.battles for one in losing}
    for placing in result:
        if placing.left or is_bot(placing.name):
            continue
        before = lost.pop(placing.name, 0)
        if placing.place > 1:
            lost[placing.name] = before + 1
    return tuple(Losing(name, battles) for name, battles in lost.items())[-REMEMBERED:]


def handicap(name: str, losing: Iterable[Losing], percent: int) -> int:
    """The percent of damage that this player is spared, when the rule is `percent`; 0: none."""
    return percent if any(one.name == name and one.battles >= IN_A_ROW for one in losing) else 0


def damage_with(handicap_percent: int, damage: int) -> int:
    """What a hit takes then: always something."""
    return -(-damage * (100 - handicap_percent) // 100)
