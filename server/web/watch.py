"""The screen for spectators: its page, and the state of the battle for those who cannot get it from rosbridge."""

import json
from collections.abc import Set
from datetime import datetime
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit

import segno
from flask import Blueprint, Response, make_response, render_template, request
from markupsafe import Markup

from laser_bot_battle.addresses import reachable_addresses
from server.game.loop import GameLoop
from server.game.robot_health import RobotsHealth
from server.game.snapshot import Placing, Player, Snapshot
from server.web.hosts import request_host
from server.web.settings import Settings


def create_watch(game: GameLoop, settings: Settings, health: RobotsHealth) -> Blueprint:
    """The routes, as a Flask blueprint."""
    pages = Blueprint("watch", __name__)

    @pages.get("/watch")
    def watch() -> str:
        address = players_address(request.scheme, request_host(), settings.program.bind, settings.program.port)
        return render_template(
            "watch.html",
            address=address,
            code=_qr_code(address),
            utc_offset=_utc_offset(),
        )

    @pages.get("/watch.json")
    def status() -> Response:
        text = json.dumps(public_status(game.snapshot(), health.weak()), ensure_ascii=False)
        return make_response(text, 200, {"Content-Type": "application/json; charset=utf-8"})

    return pages


def players_address(scheme: str, host: str, bind: str, port: int) -> str:
    """Where players reach the game: as the spectator does, `host` (with its port), unless that leads to this machine
    only. Then one of this machine's own addresses, if the server listens there: `bind`, `port`."""
    if _is_loopback(urlsplit(f"//{host}").hostname or ""):
        reachable = reachable_addresses(bind)
        if reachable:
            return f"http://{reachable[0].ip}:{port}"
    return f"{scheme}://{host}"


def public_status(snapshot: Snapshot, weak: Set[int] = frozenset()) -> dict[str, Any]:
    """A laser_bot_battle/GameStatus without what is secret, as rosbridge writes it for everybody. `weak` are robots
    with too little voltage."""
    return {
        "game": snapshot.game.value,
        "time_left": snapshot.time_left,
        "battle": snapshot.battle,
        "notice": snapshot.notice,
        "paused": snapshot.paused,
        "message": snapshot.message,
        "available_robots": snapshot.available_robots,
        "practice": snapshot.practice,
        "teams": snapshot.teams,
        "coded": snapshot.coded,
        "hide_cameras": snapshot.hide_cameras,
        "queue": [waiter.name for waiter in snapshot.queue],
        "users": [
            _person(
                player, ready=player.ready, place=0, seat_left=player.seat_left, left=False, weak=player.robot in weak
            )
            for player in snapshot.players
        ],
        "result": [
            _person(placing, ready=False, place=placing.place, seat_left=0.0, left=placing.left, weak=False)
            for placing in snapshot.result
        ],
        "events": [
            {"number": one.number, "kind": int(one.life == 0), "name": one.name, "by": one.by, "life": one.life}
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
        **more,
    }


def _is_loopback(name: str) -> bool:
    try:
        address = ip_address(name)
    except ValueError:
        return name == "localhost" or name.endswith(".localhost")
    return address.is_loopback or address.is_unspecified


def _qr_code(text: str) -> Markup:
    """As SVG, black on white in any theme: that is what cameras read."""
    code = segno.make(text, micro=False, error="m")
    return Markup(code.svg_inline(border=4, dark="#000", light="#fff", omitsize=True, svgclass=None, lineclass=None))


def _utc_offset() -> int:
    """Of this machine's time zone now, in minutes: the leaderboard's days are the server's."""
    offset = datetime.now().astimezone().utcoffset()
    return int(offset.total_seconds() // 60) if offset else 0
