"""The operators' JSON API (docs/operator-api.md): what they see, and what they decide.

Answers are application/json, refusals `{"error": why}` with 400 or more; those change nothing.
"""

import platform
import re
import time
from collections.abc import Callable
from functools import partial
from importlib import metadata
from types import NoneType
from typing import Any

from flask import Blueprint, Response, g, json, jsonify, request

from laser_bot_battle.names import VERSION, operator_ticket
from server.game import desk, tournament_desk
from server.game.bots import LEVELS
from server.game.loop import GameLoop
from server.game.robot_health import RobotsHealth
from server.store.database import AwayError, Database
from server.store.log import EventLog, as_csv, as_json
from server.web.bots import BotsProgram
from server.web.floor_api import add_floor
from server.web.floor_file import FloorFile
from server.web.journal import Journals, NothingToReadError
from server.web.operator_access import COOKIE, NAMELESS, Access, TooManyError, WrongTokenError
from server.web.operator_requests import json_body, json_object, needed, refusal, refuse
from server.web.settings import Settings
from server.web.visitors import one_address, visitor_address

PREFIX = "/operator/api/"
MAX_BODY = 256 * 1024  # bytes; the longest honest one is a list of words
JOURNAL_LINES = 200
VOTE_SECONDS, VOTE_SHORTEST, VOTE_LONGEST = 30, 5, 600
NO_TOKEN = "no operator token is set: start the server with LASERBOT_OPERATOR_TOKEN"

_ROBOT_ID = re.compile(r"[0-9]{1,3}")
_BATTLE = {"start": desk.start, "abort": desk.abort, "pause": desk.pause, "resume": desk.resume}
_NAMES = {"ban": (str,), "unban": (str,), "words": (list,)}


def create_operator_api(
    game: GameLoop,
    settings: Settings,
    access: Access,
    database: Database,
    log: EventLog,
    *,
    health: RobotsHealth,
    bots: BotsProgram,
    overhead: Callable[[], list[str]],
    identify: Callable[[int], bool],
    ask_audience: Callable[[bytes], None],
) -> Blueprint:
    """The routes, as a Flask blueprint. `overhead` tells the troubles of the camera above the floor. `identify` asks a
    robot to show itself; whether somebody there hears it. `ask_audience` passes a vote on to whoever counts
    (server.pages)."""
    api = Blueprint("operator_api", __name__, url_prefix="/operator/api")
    _add_guard(api, access)
    _add_views(api, game, settings, database=database, log=log, health=health, bots=bots, overhead=overhead)
    _add_journal(api, Journals(settings.journal) if settings.journal else None)
    _add_decisions(api, game)
    _add_identify(api, game, identify)
    _add_vote(api, game, ask_audience)
    add_floor(api, game, FloorFile(settings.floor_source))
    return api


def _add_guard(api: Blueprint, access: Access) -> None:
    @api.before_request
    def let_operators_in() -> Response | None:
        if not access.is_possible:
            return refusal(404, NO_TOKEN)
        scheme, _, token = request.headers.get("Authorization", "").partition(" ")
        if scheme.lower() != "bearer":
            g.operator = access.name(request.cookies.get(COOKIE, ""))
            return None if g.operator else refusal(401, "sign in at /operator, or send the operators' token")
        try:
            access.check(token.strip(), visitor_address())
        except WrongTokenError:
            return refusal(401, "that is not the operators' token")
        except TooManyError as error:
            response = refusal(429, "too many wrong tokens came from your address: wait a moment")
            response.headers["Retry-After"] = str(error.retry_after)
            return response
        g.operator = NAMELESS
        return None


def _add_views(
    api: Blueprint,
    game: GameLoop,
    settings: Settings,
    *,
    database: Database,
    log: EventLog,
    health: RobotsHealth,
    bots: BotsProgram,
    overhead: Callable[[], list[str]],
) -> None:
    address = settings.database.render_as_string(hide_password=True).replace(":***@", "@")
    versions = {"laserbot": VERSION, "python": platform.python_version(), "ros": _ros_version()}

    @api.get("/state")
    def state() -> Response:
        overview = game.overview()
        for robot in overview["robots"]:
            robot["health"] = health.of(robot["id"])
        return jsonify(
            time=time.time(),
            **overview,
            database={
                "url": address,
                "problem": database.problem,
                "mishap": database.mishap,
                "waiting": database.waiting,
            },
            versions={**versions, "database": database.version},
            bots={"program": bots.state(), "levels": LEVELS},
            overhead={"troubles": overhead()},
            visitors={"one_address": one_address().found(time.monotonic())},
            operator=g.operator,
            log=log.latest(),
            has_journal=settings.journal is not None,
        )

    @api.get("/drive")
    def drive() -> Response:
        game.operate(partial(desk.take_drive, by=g.operator))
        return jsonify(ticket=ticket(), port=settings.rosbridge_port)

    @api.get("/camera")
    def camera() -> Response:
        return jsonify(ticket=ticket(), port=settings.relay_port)

    @api.get("/log.json")
    def log_json() -> Response:
        return _download("application/json", "json")

    @api.get("/log.csv")
    def log_csv() -> Response:
        return _download("text/csv; charset=utf-8", "csv")

    def ticket() -> str:
        return operator_ticket(settings.operator_token, time.time())

    def _download(content_type: str, ending: str) -> Response:
        try:
            entries = log.read()
        except AwayError as error:
            return refusal(503, f"the database cannot be read now: {error}")
        response = Response((as_json if ending == "json" else as_csv)(entries), content_type=content_type)
        response.headers["Content-Disposition"] = f"attachment; filename=laserbot-log.{ending}"
        return response


def _add_journal(api: Blueprint, journals: Journals | None) -> None:
    @api.get("/journal")
    def journal() -> Response:
        if journals is None:
            return refusal(404, "this server reads no journals: set LASERBOT_JOURNAL")
        only_warnings = request.args.get("only", "") == "warnings"
        try:
            lines = journals.newest(JOURNAL_LINES, request.args.get("host", ""), only_warnings=only_warnings)
            return jsonify(hosts=journals.hosts(), lines=[line._asdict() for line in lines])
        except NothingToReadError as error:
            return refusal(503, str(error))


def _add_decisions(api: Blueprint, game: GameLoop) -> None:
    @api.post("/battle")
    def battle() -> Response:
        order = json_body(action=(str,), seconds=(int, float))
        action = needed(order, "action")
        if action == "add_time":
            return decide(desk.add_time, seconds=needed(order, "seconds"))
        if action not in _BATTLE or "seconds" in order:
            refuse(400, f"action must be one of {', '.join(_BATTLE)}, or add_time with seconds")
        return decide(_BATTLE[action])

    @api.post("/players/<name>/sign_out")
    def sign_out(name: str) -> Response:
        json_body()
        return decide(desk.sign_out, name=name)

    @api.post("/names")
    def names() -> Response:
        change = json_body(**_NAMES)
        if len(change) != 1:
            refuse(400, f"one of {', '.join(_NAMES)} is needed")
        if "words" not in change:
            return decide(desk.ban if "ban" in change else desk.unban, name=next(iter(change.values())))
        if not all(isinstance(word, str) for word in change["words"]):
            refuse(400, "words must be a list of texts")
        return decide(desk.set_words, words=change["words"])

    @api.post("/robots/<robot>")
    def robots(robot: str) -> Response:
        change, robot_id = json_body(in_service=(bool,), bot=(str, NoneType)), _robot_id(robot)
        if len(change) != 1:
            refuse(400, "one of in_service, bot is needed")
        if "bot" in change:
            return decide(desk.give_to_bot, robot_id=robot_id, level=change["bot"])
        return decide(desk.set_service, robot_id=robot_id, in_service=change["in_service"])

    @api.put("/rules")
    def rules() -> Response:
        return decide(desk.change_rules, changes=json_object())

    @api.post("/presets")
    def presets() -> Response:
        change = json_body(save=(str,), remove=(str,))
        if len(change) != 1:
            refuse(400, "one of save, remove is needed")
        return decide(desk.save_preset if "save" in change else desk.remove_preset, name=next(iter(change.values())))

    @api.post("/tournament")
    def tournament() -> Response:
        return decide(tournament_desk.order, fields=json_body(**tournament_desk.FIELDS))

    @api.post("/message")
    def message() -> Response:
        return decide(desk.show, text=needed(json_body(text=(str,)), "text"))

    def decide(wish: Any, **wanted: Any) -> Response:
        try:
            game.operate(partial(wish, by=g.operator, **wanted))
        except desk.UnknownError as error:
            return refusal(404, str(error))
        except desk.RefusedError as error:
            return refusal(409, str(error))
        except ValueError as error:
            return refusal(400, str(error))
        return jsonify({})


def _add_identify(api: Blueprint, game: GameLoop, identify: Callable[[int], bool]) -> None:
    @api.post("/robots/<robot>/identify")
    def show_itself(robot: str) -> Response:
        json_body()
        robot_id = _robot_id(robot)
        if robot_id not in game.snapshot().robots:
            refuse(404, f"there is no robot {robot_id}")
        if not identify(robot_id):
            refuse(409, f"robot {robot_id} cannot show itself: nobody there listens to /Robot{robot_id}/identify")
        return jsonify({})


def _add_vote(api: Blueprint, game: GameLoop, ask_audience: Callable[[bytes], None]) -> None:
    latest: dict[str, Any] = {}

    @api.post("/vote")
    def vote() -> Response:
        """Let spectators choose one of some presets; no choices end the vote that is open."""
        wanted = json_body(choices=(list,), seconds=(int, float))
        choices, seconds = needed(wanted, "choices"), wanted.get("seconds", VOTE_SECONDS)
        now = time.monotonic()
        if not choices:
            if not latest:
                refuse(409, "there is no vote")
            latest["ends_at"] = min(latest["ends_at"], now)
        else:
            there = [[preset["name"], preset["own"]] for preset in game.overview()["presets"]]
            given = [[one.get("name"), one.get("own")] if isinstance(one, dict) else None for one in choices]
            if len(given) < 2 or any(one not in there or given.count(one) > 1 for one in given):
                refuse(400, "choices must be two or more different presets, each with name and own")
            if not VOTE_SHORTEST <= seconds <= VOTE_LONGEST:
                refuse(400, f"seconds must be from {VOTE_SHORTEST} to {VOTE_LONGEST}")
            number = max(time.time_ns() // 1_000_000, latest.get("number", 0) + 1)  # another one after a restart, too
            latest.update(number=number, choices=given, ends_at=now + seconds)
        ask_audience(json.dumps(latest).encode() + b"\n")
        return jsonify({})


def _robot_id(text: str) -> int:
    if not _ROBOT_ID.fullmatch(text):
        refuse(404, "there is no such robot")
    return int(text)


def _ros_version() -> str:
    try:
        return metadata.version("rospy")
    except metadata.PackageNotFoundError:
        return ""
