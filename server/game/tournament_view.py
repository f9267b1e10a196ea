"""A tournament as people see it, in JSON's types."""

from collections.abc import Sequence
from statistics import fmean
from typing import Any

from server.game.draw import Match
from server.game.tournament import Tournament

_BATTLE = 120.0  # s, before there has been one
_BETWEEN = 60.0  # s from the end of a battle to the beginning of the next


def tournament_view(tournament: Tournament, lengths: Sequence[float]) -> dict[str, Any]:
    """`lengths` of the last battles, in s."""
    seconds = (fmean(lengths) if lengths else _BATTLE) + _BETWEEN
    pending = [match.number for match in tournament.pending()]
    waits = {number: place * seconds * (tournament.best_of + 1) / 2 for place, number in enumerate(pending)}
    return {
        "title": tournament.title,
        "kind": tournament.kind.value,
        "best_of": tournament.best_of,
        "version": tournament.version,
        "open": not tournament.closed,
        "names": list(tournament.names),
        "called": tournament.call.match if tournament.call else None,
        "next": following.number if (following := tournament.next_match()) else None,
        "groups": [{"number": group, "table": _table(tournament, group)} for group in range(1, tournament.groups + 1)],
        "matches": [_match(tournament, match, waits.get(match.number)) for match in tournament.matches],
        "champion": _name(tournament, tournament.champion),
    }


def _table(tournament: Tournament, group: int) -> list[dict[str, Any]]:
    return [
        {
            "place": place,
            "name": tournament.name(row.seed),
            "played": row.played,
            "won": row.won,
            "games_won": row.games_won,
            "games_lost": row.games_lost,
        }
        for place, row in enumerate(tournament.table(group), 1)
    ]


def _match(tournament: Tournament, match: Match, wait: float | None) -> dict[str, Any]:
    """`seconds`: about when it begins; None: it is decided, or will not be played."""
    result = tournament.result(match)
    is_called = tournament.call is not None and tournament.call.match == match.number
    return {
        "number": match.number,
        "round": match.round,
        "group": match.group or None,
        "third": match.third,
        "players": [_name(tournament, seed) for seed in result.players],
        "sources": [{"what": side.what, "number": side.number, "place": side.place or None} for side in match.sides],
        "wins": list(result.wins),
        "winner": _name(tournament, result.winner),
        "how": result.how if result.winner else None,
        "called": is_called,
        "robots": list(tournament.call.robots) if tournament.call and is_called else None,
        "seconds": None if tournament.closed else wait,
    }


def _name(tournament: Tournament, seed: int) -> str | None:
    return tournament.name(seed) if seed else None
