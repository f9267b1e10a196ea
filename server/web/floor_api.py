"""The floor in the operators' API: what it is, what is wrong with another one, and to have that instead."""

import json
from functools import partial
from typing import Any, NamedTuple

from flask import Blueprint, Response, g, jsonify

from laser_bot_battle.floor import Floor, FloorError, parse_floor
from laser_bot_battle.tags import floor_tags
from server.game import desk
from server.game.loop import GameLoop
from server.web.floor_file import FloorFile, OtherVersionError
from server.web.operator_requests import json_body, needed, refusal


def add_floor(api: Blueprint, game: GameLoop, file: FloorFile) -> None:
    """The routes /floor and /floor/check."""

    @api.get("/floor")
    def floor() -> Response:
        try:
            fields, version = file.read()
        except OSError as error:
            return refusal(503, f"{file.path} cannot be read: {error.strerror}")
        except ValueError as error:
            return refusal(503, f"{file.path}: {error}")
        return jsonify(floor=fields, version=version, name=file.name, path=str(file.path), is_writable=file.is_writable)

    @api.post("/floor/check")
    def check() -> Response:
        """What is wrong with a floor, and where its tags lie."""
        looked = _look_at(needed(json_body(floor=(dict,)), "floor"))
        tags = floor_tags(looked.floor) if looked.floor else {}
        parts = [problem.partition(": ") for problem in looked.problems]
        return jsonify(
            problems=[{"about": about, "error": error} for about, _, error in parts],
            tags=[{"number": number, "x": tag.x, "y": tag.y} for number, tag in tags.items()],
        )

    @api.put("/floor")
    def change() -> Response:
        wanted = json_body(floor=(dict,), version=(str,))
        fields, version = needed(wanted, "floor"), needed(wanted, "version")
        looked = _look_at(fields)
        if looked.floor is None:
            return refusal(400, looked.problems[0])
        if not file.is_writable:
            return refusal(409, f"this floor cannot be changed here: {file.name or file.path} is not to be written")
        try:
            return jsonify(version=file.write(fields, version, partial(game.lay_out, looked.floor.zones, g.operator)))
        except OtherVersionError:
            return refusal(409, "somebody else has changed the floor meanwhile: load it again")
        except desk.RefusedError as error:
            return refusal(409, str(error))
        except OSError as error:
            return refusal(503, f"{file.path} cannot be written: {error.strerror}")


class _Looked(NamedTuple):
    floor: Floor | None
    problems: list[str]


def _look_at(fields: dict[str, Any]) -> _Looked:
    try:
        return _Looked(parse_floor(json.dumps(fields).encode()), [])
    except FloorError as error:
        return _Looked(None, list(error.problems))
    except ValueError as error:
        return _Looked(None, [f"the file: {str(error).removeprefix('the file: ')}"])
