"""How a tournament stands: pure, immutable. What happens in it are events (server.game.tournament_events)."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import NamedTuple

from server.game.draw import Kind, Match, Source, draw, group_members
from server.game.people import Name, Words
from server.game.users import is_same_name

BEST_OF = (1, 3, 5)
PLAYED, NO_SHOW, CORRECTED = "played", "no_show", "corrected"


@dataclass(frozen=True, slots=True)
class Result:
    """Of a match, also of one that is not decided yet."""

    match: int
    players: tuple[int, int]  # seeds
    wins: tuple[int, int] = (0, 0)  # games
    winner: int = 0  # seed; 0: not decided
    how: str = PLAYED

    @property
    def loser(self) -> int:
        """0: not decided."""
        return sum(self.players) - self.winner if self.winner else 0


@dataclass(frozen=True, slots=True)
class Call:
    """A match is to be played now."""

    match: int
    robots: tuple[int, int]  # kept for its players
    until: float  # monotonic s; whoever is not ready by then has lost, if the other one is


class Row(NamedTuple):
    """A line of a group's table."""

    seed: int
    played: int
    won: int
    games_won: int
    games_lost: int


@dataclass(frozen=True, slots=True)
class Tournament:
    """`names` are those of the players, the best first: the seed 1 is the first of them."""

    title: Words
    kind: Kind
    names: tuple[Name, ...]
    best_of: int = 1
    third: bool = False  # the third place is played for
    groups: int = 0
    patience: float = 0.0  # s to be there and ready; 0: as long as it takes
    results: tuple[Result, ...] = ()
    call: Call | None = None
    closed: bool = False
    version: int = field(default=1, compare=False)  # grows with each change, from one tournament to the next, too

    @property
    def matches(self) -> tuple[Match, ...]:
        return draw(self.kind, len(self.names), self.groups, self.third)

    @property
    def champion(self) -> int:
        """The winner's seed; 0: nobody yet."""
        return self.result(self.matches[-1]).winner

    def match(self, number: int) -> Match | None:
        return self.matches[number - 1] if 0 < number <= len(self.matches) else None

    def name(self, seed: int) -> str:
        return self.names[seed - 1]

    def seed(self, name: str) -> int:
        """Of the player whom people would take for that one; 0: there is none."""
        return next((seed for seed, one in enumerate(self.names, 1) if is_same_name(one, name)), 0)

    def result(self, match: Match) -> Result:
        """As it stands; of players who are not known yet, seeds are 0."""
        return _stand(self)[match.number - 1]

    def table(self, group: int) -> list[Row]:
        """The best first: by matches won, then by games won less games lost, then by seed."""
        return _table(self, group, _stand(self))

    def pending(self) -> list[Match]:
        """What is still to be played, in that order: the one that is called first."""
        open_ones = [match for match, result in zip(self.matches, _stand(self), strict=True) if not result.winner]
        return sorted(open_ones, key=lambda match: (not self.call or match.number != self.call.match, match.number))

    def next_match(self) -> Match | None:
        """The first whose players are known and that is not called yet."""
        called = self.call.match if self.call else 0
        stand = _stand(self)
        playable = (match for match in self.pending() if all(stand[match.number - 1].players))
        return next((match for match in playable if match.number != called), None)

    def called(self) -> dict[str, int]:
        """The robots that are kept for the players of the match that is called, by their names."""
        match = self.match(self.call.match) if self.call else None
        if match is None or self.call is None:
            return {}
        return {
            self.name(seed): robot for seed, robot in zip(self.result(match).players, self.call.robots, strict=True)
        }

    def with_game(self, number: int, seed: int, until: float) -> "Tournament":
        """The player has won a game of that match; who plays the next one is to be ready `until` then."""
        result = _stand(self)[number - 1]
        if result.winner:
            return self
        wins = (result.wins[0] + (result.players[0] == seed), result.wins[1] + (result.players[1] == seed))
        is_decided = max(wins) > self.best_of // 2
        result = replace(result, wins=wins, winner=seed if is_decided else 0, how=PLAYED)
        return self._with(result, replace(self.call, until=until) if self.call else None)

    def with_winner(self, number: int, seed: int, how: str) -> "Tournament":
        """The match is that player's, whatever was before; later ones that get other players by that are open again."""
        result = _stand(self)[number - 1]
        need = self.best_of // 2 + 1
        if result.wins[result.players.index(seed)] < need:
            result = replace(result, wins=(need, 0) if result.players[0] == seed else (0, need))
        return self._with(replace(result, winner=seed, how=how), self.call)

    def _with(self, result: Result, call: Call | None) -> "Tournament":
        others = (one for one in self.results if one.match != result.match)
        changed = replace(self, results=(*others, result), call=call)
        begun = tuple(one for one in _stand(changed) if any(one.wins) or one.winner)
        called = call and _stand(changed)[call.match - 1]
        is_over = called and (called.winner or called.players != _stand(self)[called.match - 1].players)
        return replace(changed, results=begun, call=None if is_over else call)


@lru_cache(maxsize=8)
def _stand(tournament: Tournament) -> tuple[Result, ...]:
    """Of all matches, in their order. A result counts for the players only between whom it was."""
    known = {one.match: one for one in tournament.results}
    stand: list[Result] = []
    for match in tournament.matches:
        one, other = (_seed_of(side, tournament, stand) for side in match.sides)
        result = known.get(match.number)
        stand.append(result if result and result.players == (one, other) else Result(match.number, (one, other)))
    return tuple(stand)


def _seed_of(side: Source, tournament: Tournament, stand: Sequence[Result]) -> int:
    """0: not known yet. `stand` has the matches before."""
    if side.what == "seed":
        return side.number
    if side.what == "group":
        of_group = (match.number for match in tournament.matches if match.group == side.number)
        is_over = all(stand[number - 1].winner for number in of_group)
        return _table(tournament, side.number, stand)[side.place - 1].seed if is_over else 0
    result = stand[side.number - 1]
    return result.winner if side.what == "winner" else result.loser


def _table(tournament: Tournament, group: int, stand: Sequence[Result]) -> list[Row]:
    results = [stand[match.number - 1] for match in tournament.matches if match.group == group]
    rows = [_row(seed, results) for seed in group_members(len(tournament.names), tournament.groups)[group - 1]]
    return sorted(rows, key=lambda row: (-row.won, row.games_lost - row.games_won, row.seed))


def _row(seed: int, results: Sequence[Result]) -> Row:
    own = [result for result in results if seed in result.players and result.winner]
    sides = [result.players.index(seed) for result in own]
    return Row(
        seed,
        played=len(own),
        won=sum(result.winner == seed for result in own),
        games_won=sum(result.wins[side] for result, side in zip(own, sides, strict=True)),
        games_lost=sum(result.wins[1 - side] for result, side in zip(own, sides, strict=True)),
    )
