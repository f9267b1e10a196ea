"""What an arena tells of itself in /watch.json, read as a stranger's: nothing that it may say harms anybody. Pure."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from laser_bot_battle.names import ROBOT_IDS, Game
from server.game.people import MAX_NAME

MAX_SIZE = 256 * 1024  # bytes; 128 players are 40 kB
_MAX_WAITING = 1000


@dataclass(frozen=True, slots=True)
class Seen:
    """What the entrance has to know of an arena."""

    game: Game
    free: int  # robots that a newcomer may have
    players: int
    waiting: int  # for a robot
    has_tournament: bool
    names: frozenset[str]  # of those who play or wait


def read_seen(body: bytes) -> Seen:
    """ValueError if that is not what an arena's /watch.json has."""
    try:
        told = json.loads(body)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    if not isinstance(told, Mapping):
        raise ValueError("it is no object")
    players, waiting = _names(told, "users"), _names(told, "queue")
    return Seen(
        game=Game(_number(told, "game", Game.PLAYING)),
        free=_number(told, "available_robots", len(ROBOT_IDS)),
        players=min(len(players), len(ROBOT_IDS)),
        waiting=min(len(waiting), _MAX_WAITING),
        has_tournament=_number(told, "tournament", 1) > 0,
        names=frozenset((*players, *waiting)),
    )


def _number(told: Mapping[str, Any], field: str, highest: int) -> int:
    """From 0 on; what is more counts as `highest`."""
    value = told.get(field)
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise ValueError(f"{field} is no number from 0 on")
    return min(value, highest)


def _names(told: Mapping[str, Any], field: str) -> list[str]:
    people = told.get(field)
    if not isinstance(people, list):
        raise ValueError(f"{field} is no list")
    names = [one.get("name") if isinstance(one, Mapping) else one for one in people]
    return [name for name in names if isinstance(name, str) and 0 < len(name) <= MAX_NAME]
