"""The order of the players, best first: pure rules."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from server.game.users import DEAD, FIGHTING, QUIT, User

Standing = tuple[int, float]


class Rank(NamedTuple):
    """Sorts the best first. Equal results share a place."""

    lead: int  # seconds on hills as a number below 0; there are none but by that rule
    standing: Standing
    team: int  # that fights together stands together
    own: Standing  # within the team

    @property
    def result(self) -> tuple[int, Standing]:
        return self.lead, self.standing


def ranks(users: Iterable[User]) -> list[tuple[Rank, User]]:
    """The players, best first; equals keep their order. Who has held hills for longer stands before all others.

    Who fights alone stands as `User.standing` says. A team stands as one: the living by the life that is left to all
    of them, then the others by when their last one fell or left, the latest first. Whoever left alive ranks behind
    all teams, by when that was.
    """
    everybody = list(users)
    of_teams = {team: _of_team(team, everybody) for team in {user.team for user in everybody if user.team}}
    ranked = [(_rank(user, of_teams), user) for user in everybody]
    return sorted(ranked, key=lambda one: one[0])


def _rank(user: User, of_teams: Mapping[int, tuple[int, Standing]]) -> Rank:
    own = user.standing
    if user.team and own[0] < QUIT:
        return Rank(*of_teams[user.team], user.team, own)
    return Rank(-user.points if own[0] < QUIT else 0, own, 0, own)


def _of_team(team: int, users: Iterable[User]) -> tuple[int, Standing]:
    members = [user for user in users if user.team == team and user.ready]
    return -sum(user.points for user in members), _together(members)


def _together(members: Iterable[User]) -> Standing:
    life = sum(user.life for user in members if user.standing[0] == FIGHTING)
    if life:
        return (FIGHTING, -float(life))
    ends = [at for user in members for at in (user.died_at, user.left_at) if at is not None]
    return (DEAD, -max(ends, default=0.0))
