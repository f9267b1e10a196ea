"""The HTTP API (manual 3.1.3.2 to 3.1.3.8): what pages and robots POST, and the JSON that they get.

Answers are JSON text with sorted keys, served as `text/html; charset=utf-8` as ever: old pages parse them themselves.
Bad input gets `{"error": why, "status": ...}` with 400, a foreign user's name 403; neither changes anything.
"""

import logging
import math
import re
import secrets
from typing import Any, NoReturn

from flask import Blueprint, Response, abort, make_response, request
from jinja2.utils import htmlsafe_json_dumps

from laser_bot_battle.names import SESSION_COOKIE, Game, session_digest
from server.game.loop import GameLoop
from server.game.referee import Verdict
from server.game.snapshot import Snapshot
from server.game.users import AVATARS, is_valid_name

_log = logging.getLogger(__name__)

_ROBOT_ID = re.compile(r"-?[0-9]{1,9}")
_READY = {"0": False, "1": True}


def create_api(game: GameLoop) -> Blueprint:
    """The routes, as a Flask blueprint named `api`."""
    api = Blueprint("api", __name__)

    @api.post("/signUpUser")
    def sign_up_user() -> Response:
        name = _field("data")
        if not is_valid_name(name):
            _refuse(400, "a name is 1 to 16 letters, digits or _", user=name)
        avatar = request.form.get("avatar", "0")
        if avatar not in map(str, range(AVATARS)):
            _refuse(400, f"avatar must be 0 to {AVATARS - 1}", user=name)
        wish = request.form.get("robot")
        wanted = None if wish is None else _robot_id(wish, "robot")
        token = secrets.token_urlsafe(32)
        verdict, player = game.sign_up(name, session_digest(token), int(avatar), cookie_session(), wanted)
        if verdict is Verdict.NAME_TAKEN:
            _log.info("the name %s is taken: %s has to choose another", name, request.remote_addr)
        if verdict is Verdict.ROBOT_UNAVAILABLE:
            return reply(status="ROBOT_UNAVAILABLE", robot=wanted)
        if player is None:
            return reply(status="UNAVAILABLE" if verdict is Verdict.NAME_TAKEN else "NO_ROBOTS", user=name)
        response = reply(status="OK", user=name, robot=player.robot)
        if player.session == session_digest(token):  # else the page has its cookie already
            response.set_cookie(SESSION_COOKIE, token, httponly=True, samesite="Lax", path="/")
        return response

    @api.post("/signOutUser")
    def sign_out_user() -> Response:
        name = _field("data")
        verdict = game.sign_out(name, cookie_session() or "")
        if verdict is Verdict.UNKNOWN_USER:
            return reply(status="UNREGISTERED", user=name)
        if verdict is Verdict.NOT_YOURS:
            _refuse(403, "only that user can sign out", status="FAILED", user=name)
        response = reply(status="OK", user=name)
        response.delete_cookie(SESSION_COOKIE, path="/", httponly=True, samesite="Lax")
        return response

    @api.post("/playerReady")
    def player_ready() -> Response:
        name, ready = _field("user"), _READY.get(_field("ready"))
        if game.snapshot().game is Game.PLAYING:
            return reply(status="STARTED")
        if ready is None:
            _refuse(400, "ready must be 0 or 1", user=name)
        verdict = game.set_ready(name, ready, cookie_session() or "")
        if verdict is Verdict.STARTED:
            return reply(status="STARTED")
        if verdict is Verdict.UNKNOWN_USER:
            return reply(status="ERROR", user=name)
        if verdict is Verdict.NOT_YOURS:
            _refuse(403, "only that user can get ready", user=name)
        return reply(status="OK", user=name)

    @api.post("/updateGameStatus")
    def update_game_status() -> Response:
        return reply(status="OK", **_game_status(game.snapshot()))

    @api.post("/getAvailableRobots")
    def get_available_robots() -> Response:
        return reply(status="OK", availableR=game.snapshot().available_robots)

    @api.post("/incAlive")
    def inc_alive() -> Response:
        robot_id = _robot_id(_field("ID"), "ID")
        return reply(status="OK" if game.robot_alive(robot_id) else "ERROR")

    @api.get("/session")
    def session() -> Response:
        player = game.seen(cookie_session() or "")
        if player is None:
            return reply(status="UNREGISTERED")
        return reply(status="OK", user=player.name, robot=player.robot)

    return api


def reply(http_status: int = 200, **content: Any) -> Response:
    """A JSON answer, with a log line if it is a refusal.

    `<`, `>`, `&` and `'` are written as JSON escapes, since browsers take the body for HTML.
    """
    if http_status >= 400:
        _log.warning("%s from %s refused: %s", request.path, request.remote_addr, content.get("error"))
    response = make_response(str(htmlsafe_json_dumps(content, sort_keys=True)), http_status)
    response.headers["Content-Security-Policy"] = "default-src 'none'; frame-ancestors 'none'"
    return response


def cookie_session() -> str | None:
    """The SHA-256 (hex) of the session token that the request brings, None without one."""
    token = request.cookies.get(SESSION_COOKIE)
    return session_digest(token) if token else None


def _field(name: str) -> str:
    value = request.form.get(name)
    if value is None:
        _refuse(400, f"the form field {name} is missing")
    return value


def _robot_id(text: str, field: str) -> int:
    if not _ROBOT_ID.fullmatch(text):
        _refuse(400, f"{field} must be a whole number")
    return int(text)


def _refuse(http_status: int, error: str, status: str = "ERROR", **content: Any) -> NoReturn:
    abort(reply(http_status, error=error, status=status, **content))


def _game_status(snapshot: Snapshot) -> dict[str, Any]:
    """`users` is a string of JSON within the JSON, `timeLeft` whole seconds of the countdown (manual 3.1.3.4)."""
    users = [
        {"ready": int(player.ready), "life": player.life, "name": player.name, "robot": player.robot}
        for player in snapshot.players
    ]
    counting = snapshot.game is Game.COUNTDOWN
    return {
        "game": snapshot.game.value,
        "timeLeft": math.ceil(snapshot.time_left) if counting else 0,
        "users": str(htmlsafe_json_dumps(users)),
    }
