"""The header Host, looked at before Flask does: some values of it make routing fail with a traceback."""

import json
import logging
from collections.abc import Iterable
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

from flask import request

from laser_bot_battle.hosts import is_valid_host

_log = logging.getLogger(__name__)

_REFUSAL = json.dumps({"error": "the header Host names no host", "status": "ERROR"}).encode()


def with_valid_host(application: WSGIApplication) -> WSGIApplication:
    """The application, which gets only requests with a valid header Host or, as HTTP/1.0 has them, without one."""

    def guarded(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        if is_valid_host(environ.get("HTTP_HOST", "localhost")):
            return application(environ, start_response)
        _log.warning("a request from %s refused: its header Host names no host", environ.get("REMOTE_ADDR"))
        start_response(
            "400 BAD REQUEST",
            [
                ("Content-Type", "text/html; charset=utf-8"),
                ("Content-Length", str(len(_REFUSAL))),
                ("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'"),
                ("X-Content-Type-Options", "nosniff"),
                ("Cache-Control", "no-store"),
            ],
        )
        return [_REFUSAL]

    return guarded


def request_host() -> str:
    """The host that this request names, with its port unless that is the usual one. Werkzeug's own has no name with an
    underscore (laser_bot_master.local)."""
    host: str = request.environ.get("HTTP_HOST", "localhost")
    return host.removesuffix(":443" if request.scheme == "https" else ":80")
