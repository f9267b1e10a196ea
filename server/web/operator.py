"""The operator's desk: its page, and how a browser gets to it (docs/operator.md)."""

import logging
from collections.abc import Mapping
from http import HTTPStatus

from flask import Blueprint, Response, make_response, redirect, render_template, request

from server.web.operator_access import (
    COOKIE,
    MAX_NAME,
    NAMELESS,
    SESSION_LIFE,
    Access,
    TooManyError,
    WrongTokenError,
)
from server.web.operator_api import NO_TOKEN
from server.web.operator_requests import json_body, log_refusal, refusal
from server.web.visitors import is_secure, visitor_address

_log = logging.getLogger(__name__)


def create_operator(access: Access) -> Blueprint:
    """The routes, as a Flask blueprint."""
    pages = Blueprint("operator", __name__, url_prefix="/operator")

    @pages.get("")
    def desk() -> str:
        if not access.is_possible:
            return render_template("operator_off.html")
        name = access.name(request.cookies.get(COOKIE, ""))
        if name is None:
            return render_template("operator_login.html", code=None, longest=MAX_NAME)
        return render_template("operator.html", operator=name)

    @pages.post("/login")
    def login() -> Response:
        if not access.is_possible:
            return _refuse(404, NO_TOKEN)
        given: Mapping[str, str] = json_body(token=(str,), name=(str,)) if request.is_json else request.form
        token, name = given.get("token", ""), given.get("name", "").strip() or NAMELESS
        if not token:
            return _refuse(400, "the token is missing")
        if len(name) > MAX_NAME or not name.isprintable():
            return _refuse(400, f"a name has 1 to {MAX_NAME} printable characters")
        address = visitor_address()
        try:
            secret = access.sign_in(token, name, address)
        except WrongTokenError:
            return _refuse(401, "that is not the operators' token")
        except TooManyError as error:
            return _refuse(429, "too many wrong tokens came from your address: wait a moment", error.retry_after)
        _log.info("the operator %s has signed in from %s", name, address)
        response = _done()
        response.set_cookie(
            COOKIE, secret, max_age=SESSION_LIFE, path="/operator", httponly=True, secure=is_secure(), samesite="Strict"
        )
        return response

    @pages.post("/logout")
    def logout() -> Response:
        access.sign_out(request.cookies.get(COOKIE, ""))
        response = _done()
        response.delete_cookie(COOKIE, path="/operator", httponly=True, samesite="Strict")
        return response

    return pages


def _done() -> Response:
    """A form leads to the desk, a program needs no page."""
    return make_response("", HTTPStatus.NO_CONTENT) if request.is_json else make_response(redirect("/operator", 303))


def _refuse(code: int, error: str, retry_after: int | None = None) -> Response:
    if request.is_json:
        response = refusal(code, error)
    elif code == HTTPStatus.NOT_FOUND:
        response = make_response(render_template("operator_off.html"), code)
    else:
        log_refusal(code, error)
        response = make_response(render_template("operator_login.html", code=code, longest=MAX_NAME), code)
    if retry_after is not None:
        response.headers["Retry-After"] = str(retry_after)
    return response
