"""The state of the battle for spectators who cannot get it from rosbridge."""

import json
from collections.abc import Set
from typing import Any

from flask import Blueprint, Response, make_response

from server.game.loop import GameLoop
from server.game.robot_health import RobotsHealth
from server.game.snapshot import Placing, Player, Snapshot


def create_watch(game: GameLoop, health: RobotsHealth) -> Blueprint:
    """The route, as a Flask blueprint."""
    watch = Blueprint("watch_status", __name__)

    @watch.get("/watch.json")
    def status() -> Response:
        text = json.dumps(public_status(game.snapshot(), health.weak()), ensure_ascii=False)
        return make_response(text, 200, {"Content-Type": "application/json; charset=utf-8"})

    return watch


def public_status(snapshot: Snapshot, weak: Set[int] = frozenset()) -> dict[str, Any]:
    """A laser_bot_battle/GameStatus without what is secret, as rosbridge writes it for everybody. `weak` are robots
    with too little voltage."""
    return {
        "game": snapshot.game.value,
        "time_left": snapshot.time_left,
        "protection": snapshot.protection,
        "battle": snapshot.battle,
        "notice": snapshot.notice,
        "paused": snapshot.paused,
        "message": snapshot.message,
        "available_robots": snapshot.available_robots,
        "practice": snapshot.practice,
        "practice_beside": snapshot.practice_beside,
        "teams": snapshot.teams,
        "coded": snapshot.coded,
        "hide_cameras": snapshot.hide_cameras,
        "tournament": snapshot.tournament,
        "queue": [waiter.name for waiter in snapshot.queue],
        "users": [
            _person(
                player,
                ready=player.ready,
                may_join=player.may_join,
                fence=player.fence_bits,
                place=0,
                seat_left=player.seat_left,
                left=False,
                handicap=player.handicap,
                effects=player.effect_bits,
                taken=0,
                seconds=0.0,
                wins=0,
                weak=player.robot in weak,
            )
            for player in snapshot.players
        ],
        "result": [
            _person(
                placing,
                ready=False,
                may_join=False,
                fence=0,
                place=placing.place,
                seat_left=0.0,
                left=placing.left,
                handicap=0,
                effects=0,
                taken=placing.taken,
                seconds=placing.seconds,
                wins=placing.wins,
                weak=False,
            )
            for placing in snapshot.result
        ],
        "places": [{"kind": one.number, "x": one.x, "y": one.y, "radius": one.radius} for one in snapshot.places],
        "events": [
            {
                "number": one.number,
                "kind": one.kind,
                "name": one.name,
                "by": one.by,
                "life": one.life,
                "streak": one.streak,
                "revenge": one.revenge,
            }
            for one in snapshot.happened
        ],
    }


def _person(who: Player | Placing, **more: Any) -> dict[str, Any]:
    return {
        "name": who.name,
        "robot": who.robot,
        "life": who.life,
        "avatar": who.avatar,
        "team": who.team,
        "shots": who.shots,
        "hits": who.hits,
        "kills": who.kills,
        "points": who.points,
        **more,
    }
