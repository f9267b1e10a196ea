"""The HTTP API (manual 3.1.3.2 to 3.1.3.8): what pages and robots POST, and the JSON that they get.

Answers are JSON text with sorted keys, served as `text/html; charset=utf-8` as ever: old pages parse them themselves.
Bad input gets `{"error": why, "status": ...}` with 400, a foreign user's name 403; neither changes anything.
"""

import logging
import math
import re
import secrets
import time
import unicodedata
from collections.abc import Mapping
from typing import Any, NoReturn

from flask import Blueprint, Response, abort, make_response, request
from jinja2.utils import htmlsafe_json_dumps
from werkzeug.wrappers import Request

from laser_bot_battle.addresses import machine_of
from laser_bot_battle.names import Game, session_digest, session_ticket
from laser_bot_battle.token_bucket import TokenBuckets
from server.game.loop import GameLoop
from server.game.people import MAX_NAME
from server.game.referee import Verdict
from server.game.snapshot import Player, Snapshot, Waiter
from server.game.users import AVATARS, is_reserved_name, is_valid_name
from server.web.sessions import brought_token, end_session, give_session, remember_name, token_of
from server.web.visitors import SignUps, is_this_machine, visitor_address, visitor_mark

API = "api"  # the blueprint's name

_log = logging.getLogger(__name__)

_ROBOT_ID = re.compile(r"-?[0-9]{1,9}")
WISHES = 20  # of one player to be ready or not, at once; then
WISH_PERIOD = 1.0  # s for each further one
_TEAM = re.compile("[0-4]")
_FLAG = {"0": False, "1": True}


def create_api(game: GameLoop) -> Blueprint:
    """The routes, as a Flask blueprint."""
    api = Blueprint(API, __name__)
    _add_sign_up(api, game)
    _add_seats(api, game)
    _add_battle(api, game)
    _add_restarting(api, game)
    return api


def _add_sign_up(api: Blueprint, game: GameLoop) -> None:
    """How one becomes a player, or who waits to be one."""
    sign_ups = SignUps()

    @api.post("/signUpUser")
    def sign_up_user() -> Response:
        name = unicodedata.normalize("NFC", _field("data"))
        if not is_valid_name(name):
            _refuse(400, f"a name is 1 to {MAX_NAME} letters, digits, _ and single spaces between them", user=name)
        if is_reserved_name(name):
            _refuse(400, f"the name {name} is reserved: choose another", user=name)
        avatar = request.form.get("avatar", "0")
        if avatar not in map(str, range(AVATARS)):
            _refuse(400, f"avatar must be 0 to {AVATARS - 1}", user=name)
        wish = request.form.get("robot")
        wanted = None if wish is None else _robot_id(wish, "robot")
        wait = _FLAG.get(request.form.get("wait", "0"))
        if wait is None:
            _refuse(400, "wait must be 0 or 1", user=name)
        seconds = math.ceil(sign_ups.wait(name))
        if seconds:
            return _too_fast(f"too many sign-ups from your address: again in {seconds} s", seconds)
        token = brought_token() or secrets.token_urlsafe(32)
        verdict, who = game.sign_up(
            name,
            session_digest(token),
            int(avatar),
            old_session=cookie_session(),
            wanted=wanted,
            wait=wait,
            address=visitor_mark(),
        )
        if verdict is Verdict.NAME_TAKEN:
            _log.info("the name %s is taken: %s has to choose another", name, visitor_address())
        if verdict is Verdict.NAME_BANNED:
            _refuse(403, "the operator has banned this name: choose another", user=name)
        if verdict is Verdict.NAME_UNWANTED:
            _refuse(403, "this name has a word in it that is not allowed here: choose another", user=name)
        if verdict is Verdict.ROBOT_UNAVAILABLE:
            return reply(status="ROBOT_UNAVAILABLE", robot=wanted)
        if who is None:
            return reply(status="UNAVAILABLE" if verdict is Verdict.NAME_TAKEN else "NO_ROBOTS", user=name)
        response = reply(**_seat(who))
        if who.session == session_digest(token):  # else the page has its cookie already
            give_session(response, token)
        remember_name(response, name, int(avatar))
        return response


def _add_seats(api: Blueprint, game: GameLoop) -> None:
    """Who plays, who waits, and on which robot."""

    @api.post("/signOutUser")
    def sign_out_user() -> Response:
        name = _field("data")
        verdict = game.sign_out(name, cookie_session() or "")
        if verdict is Verdict.UNKNOWN_USER:
            return reply(status="UNREGISTERED", user=name)
        if verdict is Verdict.NOT_YOURS:
            _refuse(403, "only that user can sign out", status="FAILED", user=name)
        response = reply(status="OK", user=name)
        end_session(response)
        return response

    @api.post("/takeRobot")
    def take_robot() -> Response:
        """A player who waits takes the robot that is offered."""
        verdict, player = game.take_offer(cookie_session() or "")
        if player is None:
            return reply(status="UNREGISTERED" if verdict is Verdict.UNKNOWN_USER else "NO_ROBOTS")
        return reply(**_seat(player))

    @api.get("/session")
    def session() -> Response:
        who = game.seen(cookie_session() or "")
        if who is None:
            return reply(status="UNREGISTERED")
        ticket = session_ticket(who.session, time.time())  # by which the page signs in to rosbridge
        return reply(**_seat(who), ticket=ticket)


def _add_battle(api: Blueprint, game: GameLoop) -> None:
    """What players and robots tell and ask."""

    wishes = TokenBuckets(WISHES, WISH_PERIOD)

    @api.post("/playerReady")
    def player_ready() -> Response:
        name, ready = _field("user"), _FLAG.get(_field("ready"))
        snapshot = game.snapshot()
        if snapshot.game is Game.PLAYING and not snapshot.is_open:
            return reply(status="STARTED")
        if ready is None:
            _refuse(400, "ready must be 0 or 1", user=name)
        session = cookie_session() or ""
        seconds = math.ceil(wishes.take(session or visitor_mark(), time.monotonic()))
        if seconds:
            return _too_fast(f"too many changes: again in {seconds} s", seconds)
        verdict = game.set_ready(name, ready, session)
        if verdict is Verdict.STARTED:
            return reply(status="STARTED")
        if verdict is Verdict.UNKNOWN_USER:
            return reply(status="ERROR", user=name)
        if verdict is Verdict.ROBOT_AWAY:
            return reply(status="ROBOT_UNAVAILABLE", user=name)
        if verdict is Verdict.NOT_YOURS:
            _refuse(403, "only that user can get ready", user=name)
        return reply(status="OK", user=name)

    @api.post("/chooseTeam")
    def choose_team() -> Response:
        """For the battles to come; 0: the referee deals it."""
        name, team = _field("user"), _field("team")
        session = cookie_session() or ""
        seconds = math.ceil(wishes.take(session or visitor_mark(), time.monotonic()))
        if seconds:
            return _too_fast(f"too many changes: again in {seconds} s", seconds)
        verdict = game.choose_team(name, int(team) if _TEAM.fullmatch(team) else -1, session)
        if verdict is Verdict.STARTED:
            return reply(status="STARTED")
        if verdict is Verdict.UNKNOWN_USER:
            return reply(status="ERROR", user=name)
        if verdict is Verdict.NOT_YOURS:
            _refuse(403, "only that user can choose the team", user=name)
        if verdict is Verdict.NO_TEAM:
            teams = game.snapshot().teams
            _refuse(
                400, f"team must be 0 to {teams}" if teams else "there are no teams: everybody fights alone", user=name
            )
        return reply(status="OK", user=name)

    status = _GameStatus()

    @api.post("/updateGameStatus")
    def update_game_status() -> Response:
        return _response(status.text(game.snapshot()))

    @api.post("/getAvailableRobots")
    def get_available_robots() -> Response:
        """What the login page shows: also what the operators tell everybody."""
        snapshot = game.snapshot()
        free = snapshot.free_robots
        return reply(status="OK", availableR=len(free), robots=free, message=snapshot.message)

    @api.post("/incAlive")
    def inc_alive() -> Response:
        robot_id = _robot_id(_field("ID"), "ID")
        leaving = _FLAG.get(request.form.get("leaving", "0"))
        if leaving is None:
            _refuse(400, "leaving must be 0 or 1")
        # a robot on this machine may have registered by one of its addresses, and ping by another
        address = machine_of(visitor_address())
        verdict = game.robot_alive(robot_id, key=request.form.get("key", ""), address=address, leaving=leaving)
        if verdict is Verdict.NOT_YOURS:
            _refuse(403, "only that robot can say that it is alive")
        return reply(status="OK" if verdict is Verdict.OK else "ERROR")


def _add_restarting(api: Blueprint, game: GameLoop) -> None:
    """For what a battle needs, before it is restarted: `laser_bot_battle.restarting` asks."""

    @api.post("/restarting")
    def restarting() -> Response:
        name, address = request.form.get("robot", ""), machine_of(visitor_address())
        return reply(status="OK", wait=math.ceil(game.restarting(name, address, is_local=is_this_machine())))


def reply(http_status: int = 200, **content: Any) -> Response:
    """A JSON answer, with a log line if it is a refusal.

    `<`, `>`, `&` and `'` are written as JSON escapes, since browsers take the body for HTML.
    """
    if http_status >= 400:
        _log.warning("%s from %s refused: %s", request.path, visitor_address(), content.get("error"))
    return _response(_text(content), http_status)


def _text(content: Mapping[str, Any]) -> str:
    return str(htmlsafe_json_dumps(content, sort_keys=True))


def _response(text: str, http_status: int = 200) -> Response:
    response = make_response(text, http_status)
    response.headers["Content-Security-Policy"] = "default-src 'none'; frame-ancestors 'none'"
    return response


def cookie_session() -> str | None:
    """The SHA-256 (hex) of the session token that the request brings, None without one."""
    return session_of(request)


def session_of(request: Request) -> str | None:
    """The same, of that request."""
    token = token_of(request)
    return session_digest(token) if token else None


def _too_fast(error: str, seconds: int) -> Response:
    response = reply(429, error=error, status="ERROR")
    response.headers["Retry-After"] = str(seconds)
    return response


def _seat(who: Player | Waiter) -> dict[str, Any]:
    """What the own page may know of a player, or of somebody who waits to be one; `seconds`: see Waiter."""
    if isinstance(who, Player):
        return {"status": "OK", "user": who.name, "robot": who.robot}
    return {
        "status": "QUEUED",
        "user": who.name,
        "place": who.place,
        "offer": who.offer,
        "seconds": math.ceil(who.seconds),
    }


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


class _GameStatus:
    """The answer of /updateGameStatus, written anew only when it is another one: every page asks twice a second."""

    def __init__(self) -> None:
        self._last: tuple[object, str] = (None, "")

    def text(self, snapshot: Snapshot) -> str:
        """`users` is a string of JSON within the JSON, `timeLeft` whole seconds of the countdown (manual 3.1.3.4)."""
        time_left = math.ceil(snapshot.time_left) if snapshot.game is Game.COUNTDOWN else 0
        told = (snapshot.game, time_left, snapshot.players)
        known, text = self._last  # of any thread's; one tuple, so the two belong together
        if told != known:
            users = [
                {"ready": int(player.ready), "life": player.life, "name": player.name, "robot": player.robot}
                for player in snapshot.players
            ]
            text = _text(
                {
                    "status": "OK",
                    "game": snapshot.game.value,
                    "timeLeft": time_left,
                    "users": str(htmlsafe_json_dumps(users)),
                }
            )
            self._last = told, text
        return text
