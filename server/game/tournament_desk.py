"""What operators may decide in a tournament: wishes as those of server.game.desk."""

import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from laser_bot_battle.names import Game
from server.game import events
from server.game import tournament_events as matters
from server.game.desk import EARLIER, RefusedError, UnknownError
from server.game.draw import LEAST, MOST, Kind, Match, group_numbers, usual_groups
from server.game.events import Event
from server.game.rules import Rules
from server.game.state import State
from server.game.tournament import BEST_OF, Tournament
from server.game.users import is_same_name, is_valid_name

MAX_TITLE = 40  # characters
MAX_REASON = 100
MAX_PATIENCE = 3600  # s
_MAKES_ROOM = "makes room for a match of the tournament"


def open_one(
    state: State,
    _rules: Rules,
    by: str,
    *,
    names: Sequence[object],
    kind: str = Kind.KNOCK_OUT,
    title: str = "",
    best_of: int = 1,
    third: bool = False,
    groups: int = 0,
    patience: float = 180,
) -> list[Event]:
    """A tournament of these players, the best first. `groups` 0: as many as usual. ValueError for what cannot be."""
    if state.tournament and not state.tournament.closed:
        raise RefusedError("a tournament is open already: close it first")
    if kind not in list(Kind):
        raise ValueError(f"kind must be one of {', '.join(Kind)}")
    if best_of not in BEST_OF:
        raise ValueError("best_of must be 1, 3 or 5")
    if not 0 <= patience <= MAX_PATIENCE:
        raise ValueError(f"patience must be 0 to {MAX_PATIENCE} s")
    players = _names(names)
    title = _text(title or "Tournament", MAX_TITLE, "a title")
    if kind == Kind.KNOCK_OUT:
        groups = 0
    elif groups == 0:
        groups = usual_groups(len(players))
    elif groups not in group_numbers(len(players)):
        least, *_, most = [*group_numbers(len(players))] * 2
        raise ValueError(f"so many players can be in {least} to {most} groups")
    has_third = third and groups != 1  # in a single group, somebody is third already
    return [matters.TournamentOpened(title, Kind(kind).value, players, best_of, has_third, groups, patience, by)]


def call(state: State, _rules: Rules, by: str, number: int | None = None) -> list[Event]:
    """The match, or the next one, is to be played now: robots are kept for its players, ahead of everybody else."""
    tournament = _open(state)
    if state.game is not Game.STOPPED:
        raise RefusedError("wait for the end of the countdown or battle that runs")
    match = tournament.next_match() if number is None else _match(tournament, number)
    if match is None:
        raise RefusedError("there is no other match to call now")
    result = tournament.result(match)
    if result.winner:
        raise RefusedError(f"match {match.number} is decided: correct it instead")
    if not all(result.players):
        raise RefusedError(f"match {match.number} waits for its players: play the matches before it first")
    names = tuple(tournament.name(seed) for seed in result.players)
    robots = _robots(state, names)
    unseated: list[Event] = []
    for user in state.users:
        if any(is_same_name(user.name, name) for name in names):
            continue
        if user.ready:
            unseated.append(events.ReadyChanged(user.name, False))
        if user.robot in robots:
            unseated.append(events.Unseated(user.name, _MAKES_ROOM, first=True))
    return [matters.MatchCalled(match.number, names, robots, by), *unseated]


def no_show(state: State, _rules: Rules, by: str, number: int, name: str) -> list[Event]:
    """Whoever is not there loses the match."""
    tournament = _open(state)
    match = _match(tournament, number)
    result = tournament.result(match)
    absent = tournament.seed(name)
    if not absent or absent not in result.players or not all(result.players):
        raise UnknownError(f"{name} does not play match {number} now")
    if result.winner:
        raise RefusedError(f"match {number} is decided: correct it instead")
    if state.game is not Game.STOPPED and tournament.call and tournament.call.match == number:
        raise RefusedError("a battle is running: abort it first")
    winner = tournament.name(sum(result.players) - absent)
    return [matters.NoShow(number, tournament.name(absent), winner, by)]


def correct(state: State, _rules: Rules, by: str, number: int, winner: str, reason: str) -> list[Event]:
    """The operator says who has won. ValueError without a reason."""
    tournament = _open(state)
    result = tournament.result(_match(tournament, number))
    seed = tournament.seed(winner)
    if not seed or seed not in result.players or not all(result.players):
        raise UnknownError(f"{winner} does not play match {number}")
    if result.winner == seed:
        raise RefusedError(f"{winner} has won match {number} already")
    return [matters.MatchCorrected(number, tournament.name(seed), _text(reason, MAX_REASON, "a reason"), by)]


def close(state: State, _rules: Rules, by: str) -> list[Event]:
    """Nothing of it is played any more; its results stay until another one is opened."""
    _open(state)
    return [matters.TournamentClosed(by)]


# what an operator may order: the wish, the fields that it needs, and those that it may have
_ORDERS: Mapping[str, tuple[Callable[..., list[Event]], set[str], set[str]]] = {
    "open": (open_one, {"names"}, {"kind", "title", "best_of", "third", "groups", "patience"}),
    "call": (call, set(), {"number"}),
    "no_show": (no_show, {"number", "name"}, set()),
    "correct": (correct, {"number", "winner", "reason"}, set()),
    "close": (close, set(), set()),
}
# the types of all fields, in JSON's terms
FIELDS: Mapping[str, tuple[type, ...]] = {
    "action": (str,),
    "names": (list,),
    "kind": (str,),
    "title": (str,),
    "best_of": (int,),
    "third": (bool,),
    "groups": (int,),
    "patience": (int, float),
    "number": (int,),
    "name": (str,),
    "winner": (str,),
    "reason": (str,),
}


def order(state: State, rules: Rules, by: str, fields: Mapping[str, Any]) -> list[Event]:
    """What the field `action` says, with the others. ValueError if they do not fit together."""
    wanted = dict(fields)
    wish, needed, possible = _ORDERS.get(wanted.pop("action", ""), (None, set(), set()))
    if wish is None:
        raise ValueError(f"action must be one of {', '.join(_ORDERS)}")
    if missing := sorted(needed - wanted.keys()):
        raise ValueError(f"the field {missing[0]} is missing")
    if unknown := sorted(wanted.keys() - needed - possible):
        raise ValueError(f"the field {unknown[0]} does not belong to {fields['action']}")
    return wish(state, rules, by, **wanted)


def take_over(state: State, saved: Mapping[str, Any]) -> Iterable[Event]:
    """What an earlier program had decided, whose `saved` state could not be read at the start."""
    if state.tournament is not None or not saved:
        return
    yield matters.TournamentOpened(
        saved["title"],
        saved["kind"],
        tuple(saved["names"]),
        saved["best_of"],
        saved["third"],
        saved["groups"],
        saved["patience"],
        EARLIER,
    )
    for result in saved["results"]:
        if result["winner"]:
            winner = saved["names"][result["winner"] - 1]
            yield matters.MatchCorrected(result["match"], winner, "decided before", EARLIER)
    if saved["closed"]:
        yield matters.TournamentClosed(EARLIER)


def _open(state: State) -> Tournament:
    if state.tournament is None or state.tournament.closed:
        raise RefusedError("no tournament is open")
    return state.tournament


def _match(tournament: Tournament, number: int) -> Match:
    match = tournament.match(number)
    if match is None:
        raise UnknownError(f"there is no match {number}")
    return match


def _names(given: Sequence[object]) -> tuple[str, ...]:
    names = tuple(unicodedata.normalize("NFC", name).strip() if isinstance(name, str) else "" for name in given)
    if not LEAST <= len(names) <= MOST:
        raise ValueError(f"a tournament has {LEAST} to {MOST} players")
    for place, name in enumerate(names):
        if not is_valid_name(name):
            raise ValueError(f"{str(given[place])[:40]!r} is no name that a player could have")
        if any(is_same_name(name, other) for other in names[:place]):
            raise ValueError(f"{name} is in the list twice")
    return names


def _text(text: str, most: int, what: str) -> str:
    text = text.strip()
    if not 0 < len(text) <= most or not text.isprintable():
        raise ValueError(f"{what} has 1 to {most} printable characters")
    return text


def _robots(state: State, names: Sequence[str]) -> tuple[int, ...]:
    """One for each: the own one, else one that is free, else one of somebody who does not play in this match."""
    own = {
        name: user.robot
        for name in names
        for user in state.users
        if is_same_name(user.name, name) and user.robot_gone_at is None
    }
    offered = {
        name: waiting.offer
        for name in names
        for waiting in state.queue
        if is_same_name(waiting.name, name) and waiting.offer is not None
    }
    own = {**offered, **own}
    others = {user.robot for user in state.users} - set(own.values())
    usable = [robot for robot in state.robots if robot.in_service and robot.linked and robot.id not in own.values()]
    free = [robot.id for robot in usable if robot.user is None] + [one.id for one in usable if one.id in others]
    if len(free) + len(own) < len(names):
        raise RefusedError("a match takes two robots that are here, in service and offered to nobody else")
    return tuple(own[name] if name in own else free.pop(0) for name in names)
