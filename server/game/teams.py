"""Who fights for which team: pure rules."""

from collections.abc import Sequence

from server.game.users import User


def deal(fighters: Sequence[User], teams: int) -> list[int]:
    """The team of each fighter, 1 to `teams`; 0 for all when there are none.

    Who has chosen a team gets it; all others go, one after another, to the smallest. When all have chosen the same one
    there would be no battle: then nobody has chosen.
    """
    if not teams:
        return [0] * len(fighters)
    wishes = [user.wish if user.wish <= teams else 0 for user in fighters]
    if len(set(wishes)) == 1:
        wishes = [0] * len(fighters)
    dealt = wishes[:]
    for number, wish in enumerate(wishes):
        if not wish:
            dealt[number] = min(range(1, teams + 1), key=lambda team: (dealt.count(team), team))
    return dealt


def sides(alive: Sequence[User]) -> int:
    """How many teams there are among these, or fighters who fight alone."""
    return len({user.team for user in alive if user.team}) + sum(not user.team for user in alive)


def are_friends(one: User, other: User) -> bool:
    return one.team != 0 and one.team == other.team
