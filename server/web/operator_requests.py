"""What operators' requests bring, and how they are refused."""

import logging
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any, NoReturn

from flask import Response, abort, json, jsonify, request

from server.web.visitors import visitor_address

_log = logging.getLogger(__name__)


def refusal(code: int, error: str) -> Response:
    """The answer to what was wrong, and a line of log."""
    log_refusal(code, error)
    response = jsonify(error=error)
    response.status_code = code
    return response


def log_refusal(code: int, error: str) -> None:
    """A line of log, but none for guesses that come too often: whoever guesses says how many these are."""
    if code != HTTPStatus.TOO_MANY_REQUESTS:
        _log.warning("%s from %s refused: %s", request.path, visitor_address(), error)


def json_body(**fields: tuple[type, ...]) -> dict[str, Any]:
    """The request's JSON object, which may have these fields of these types; another one is refused."""
    content = json_object()
    for name, value in content.items():
        if name not in fields:
            refuse(400, f"there is no field {name[:40]!r}; there are: {', '.join(fields) or 'none'}")
        if type(value) not in fields[name]:
            refuse(400, f"the field {name} is of a wrong type")
    return content


def json_object() -> dict[str, Any]:
    if not request.is_json:
        refuse(415, "the body must be JSON: Content-Type: application/json")
    try:
        content = json.loads(request.get_data())
    except (ValueError, RecursionError):
        refuse(400, "the body is not JSON")
    if not isinstance(content, dict):
        refuse(400, "the body must be a JSON object")
    return content


def needed(content: Mapping[str, Any], field: str) -> Any:
    if field not in content:
        refuse(400, f"the field {field} is missing")
    return content[field]


def refuse(code: int, error: str) -> NoReturn:
    abort(refusal(code, error))
