"""How a tournament goes on with the game: what its events change, and what the rules decide in it. Pure."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from laser_bot_battle.names import Game
from server.game import tournament_events as events
from server.game.draw import Kind
from server.game.snapshot import Placing
from server.game.state import State
from server.game.tournament import CORRECTED, NO_SHOW, Call, Result, Tournament
from server.game.users import is_same_name

GRACE = 30.0  # s in which the other one may get ready, too, though the time is over


def follow(tournament: Tournament | None, event: events.TournamentEvent, at: float) -> Tournament | None:
    """The tournament after the event. One that does not fit, as of another version, changes nothing."""
    if isinstance(event, events.TournamentOpened):
        return Tournament(
            event.title,
            Kind(event.mode),
            event.names,
            event.best_of,
            event.third,
            event.groups,
            event.patience,
            version=tournament.version + 1 if tournament else 1,
        )
    if tournament is None:
        return None
    return replace(_after(tournament, event, at), version=tournament.version + 1)


def _after(tournament: Tournament, event: events.TournamentEvent, at: float) -> Tournament:
    match event:
        case events.MatchCalled(number, _, (one, other)):
            return replace(tournament, call=Call(number, (one, other), at + tournament.patience))
        case events.GameWon(number, name):
            return tournament.with_game(number, tournament.seed(name), at + tournament.patience)
        case events.NoShow(number, _, winner):
            return tournament.with_winner(number, tournament.seed(winner), NO_SHOW)
        case events.MatchCorrected(number, winner):
            return tournament.with_winner(number, tournament.seed(winner), CORRECTED)
        case events.TournamentClosed():
            return replace(tournament, call=None, closed=True)
    return tournament


def delay(tournament: Tournament | None, seconds: float) -> Tournament | None:
    """Nobody's absence in that time counts."""
    if tournament is None or tournament.call is None:
        return tournament
    return replace(tournament, call=replace(tournament.call, until=tournament.call.until + seconds))


def release(tournament: Tournament | None, held_at: float, at: float) -> Tournament | None:
    """Battles were held up since then: that was no time to get ready in, and now there is some in any case."""
    delayed = delay(tournament, at - held_at)
    if delayed is None or delayed.call is None:
        return delayed
    return replace(delayed, call=replace(delayed.call, until=max(delayed.call.until, at + GRACE)))


def game_won(state: State, battle: int, result: Sequence[Placing]) -> list[events.GameWon]:
    """What the battle's result means for the match that is called: nothing if both share a place, or one was not in
    it."""
    tournament = state.tournament
    if tournament is None or tournament.call is None:
        return []
    names = tournament.called()
    placed = [(one.place, name) for name in names for one in result if is_same_name(one.name, name)]
    if len(placed) < 2 or placed[0][0] == placed[1][0]:
        return []
    return [events.GameWon(tournament.call.match, min(placed)[1], battle)]


def no_show(state: State) -> tuple[float, events.NoShow] | None:
    """Who loses for not being ready, and when. Where nobody is, it is for the operator to say."""
    tournament = state.tournament
    if tournament is None or tournament.call is None or not tournament.patience:
        return None
    if state.game is not Game.STOPPED or state.held is not None:
        return None
    called, ready = tournament.called(), state.users.get_users_ready()
    ready_since = {name: user.ready_since for name in called for user in ready if is_same_name(user.name, name)}
    absent = [name for name in called if name not in ready_since]
    if len(absent) != 1 or len(ready_since) != 1:
        return None
    (winner, since), *_ = ready_since.items()
    return max(tournament.call.until, since + GRACE), events.NoShow(tournament.call.match, absent[0], winner)


def save(tournament: Tournament, now: float) -> dict[str, Any]:
    """In JSON's types, at the time `now`."""
    call = tournament.call
    return {
        "title": tournament.title,
        "kind": tournament.kind.value,
        "names": list(tournament.names),
        "best_of": tournament.best_of,
        "third": tournament.third,
        "groups": tournament.groups,
        "patience": tournament.patience,
        "results": [
            {"match": one.match, "players": [*one.players], "wins": [*one.wins], "winner": one.winner, "how": one.how}
            for one in tournament.results
        ],
        "call": call and {"match": call.match, "robots": [*call.robots], "left": call.until - now},
        "closed": tournament.closed,
        "version": tournament.version,
    }


def restore(saved: dict[str, Any], then: float) -> Tournament:
    """The tournament that was saved at the time `then`. KeyError, TypeError or ValueError if it is none."""
    call = saved["call"]
    return Tournament(
        str(saved["title"]),
        Kind(saved["kind"]),
        tuple(map(str, saved["names"])),
        int(saved["best_of"]),
        bool(saved["third"]),
        int(saved["groups"]),
        float(saved["patience"]),
        results=tuple(_restore_result(one) for one in saved["results"]),
        call=Call(int(call["match"]), _pair(call["robots"]), then + float(call["left"])) if call else None,
        closed=bool(saved["closed"]),
        version=int(saved["version"]),
    )


def _restore_result(saved: dict[str, Any]) -> Result:
    players, wins = _pair(saved["players"]), _pair(saved["wins"])
    return Result(int(saved["match"]), players, wins, int(saved["winner"]), str(saved["how"]))


def _pair(values: Sequence[Any]) -> tuple[int, int]:
    one, other = values
    return int(one), int(other)
