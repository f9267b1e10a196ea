"""All that an operator sees of the game, in JSON's types."""

from typing import Any

from laser_bot_battle.names import robot_name
from server.game.bots import bots
from server.game.desk import why_no_start
from server.game.places import RULES as RULES_OF_PLACE
from server.game.presets import BUILT_IN
from server.game.rules import DECLARED, Rules
from server.game.snapshot import Snapshot
from server.game.state import State
from server.game.tournament_view import tournament_view


def overview(
    state: State, rules: Rules, configured: Rules, snapshot: Snapshot, now: float, *, places_known: bool
) -> dict[str, Any]:
    """`snapshot` is that of the same moment, `configured` are the rules without what operators have changed.
    `places_known`: somebody tells where the robots are."""
    return {
        "game": {
            "state": state.game.name.lower(),
            "paused": snapshot.paused,
            "why_no_start": why_no_start(state),
            "time_left": snapshot.time_left,
            "battle": snapshot.battle,
            "notice": snapshot.notice,
            "message": snapshot.message,
        },
        "robots": _robots(state, rules, now),
        "players": [
            {
                "name": player.name,
                "robot": player.robot,
                "life": player.life,
                "ready": player.ready,
                "avatar": player.avatar,
                "team": player.team,
                "shots": player.shots,
                "hits": player.hits,
                "kills": player.kills,
                "seat_left": player.seat_left,
                "page_age": now - state.users.user(player.name).seen,
            }
            for player in snapshot.players
        ],
        "queue": [
            {"name": waiter.name, "place": waiter.place, "offer": waiter.offer, "seconds": waiter.seconds}
            for waiter in snapshot.queue
        ],
        "rules": {
            name: {
                "value": getattr(rules, name),
                "default": getattr(configured, name),
                "min": variable.lowest,
                "max": variable.highest,
                "words": list(variable.words),
                "text": variable.text,
                "idle": name in RULES_OF_PLACE and not places_known,
            }
            for name, variable in DECLARED.items()
        },
        "presets": [
            {"name": preset.name, "own": own, "rules": dict(preset.rules)}
            for own, presets in ((False, BUILT_IN), (True, state.presets))
            for preset in presets
        ],
        "tournament": state.tournament and tournament_view(state.tournament, state.lengths),
        "names": {"banned": list(state.banned), "words": list(state.words)},
    }


def _robots(state: State, rules: Rules, now: float) -> list[dict[str, Any]]:
    """Those that are here, and those that are away but out of service."""
    callers = {robot_id: caller for caller, robot_id in state.robots.known.items()}
    ids = {robot.id for robot in state.robots} | state.robots.out_of_service
    levels = bots(state, rules)
    return [
        {**_robot(state, robot_id, callers.get(robot_id), now), "bot": levels.get(robot_id)} for robot_id in sorted(ids)
    ]


def _robot(state: State, robot_id: int, caller: str | None, now: float) -> dict[str, Any]:
    robot = state.robots.get_robot(robot_id)
    offered = next((waiting.name for waiting in state.queue if waiting.offer == robot_id), None)
    return {
        "id": robot_id,
        "name": robot_name(caller) if caller else None,
        "host": robot.address or None if robot else None,
        "player": next((user.name for user in state.users if user.robot == robot_id), None),
        "offered_to": offered,
        "in_service": robot_id not in state.robots.out_of_service,
        "ping_age": now - robot.alive_at if robot else None,
        "linked": robot is not None and robot.linked,
    }
