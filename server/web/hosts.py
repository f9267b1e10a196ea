"""What host and scheme a visitor has asked for, looked at before Flask does."""

import json
import logging
from collections.abc import Iterable, Sequence
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

from flask import request

from laser_bot_battle.hosts import is_valid_host
from laser_bot_battle.proxies import HOST, SCHEME, Network, asked

_log = logging.getLogger(__name__)

_REFUSAL = json.dumps({"error": "the header Host names no host", "status": "ERROR"}).encode()


def _key(header: str) -> str:
    """As WSGI calls it."""
    return f"HTTP_{header.upper().replace('-', '_')}"


def as_asked(application: WSGIApplication, proxies: Sequence[Network]) -> WSGIApplication:
    """The application, which gets each request as its visitor has sent it: with the host and the scheme that a believed
    proxy tells, and nothing that others say of these."""

    def told(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        scheme, host = asked(environ.get("REMOTE_ADDR", ""), lambda header: environ.get(_key(header)), proxies)
        environ["wsgi.url_scheme"] = environ[_key(SCHEME)] = scheme  # the header, too: it goes to the pages' process
        environ.pop(_key(HOST), None)
        if host is not None:
            environ["HTTP_HOST"] = host
        return application(environ, start_response)

    return told


def as_told(application: WSGIApplication) -> WSGIApplication:
    """The application of another process, which gets requests only from `as_asked`."""

    def told(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        environ["wsgi.url_scheme"] = environ.get(_key(SCHEME), "http")
        return application(environ, start_response)

    return told


def with_valid_host(application: WSGIApplication) -> WSGIApplication:
    """The application, which gets only requests with a valid header Host or, as HTTP/1.0 has them, without one: some
    values of it make routing fail with a traceback."""

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
    """The host that the visitor asked for, with its port unless that is the usual one. Werkzeug's own has no name with
    an underscore (laser_bot_master.local)."""
    host: str = request.environ.get("HTTP_HOST", "localhost")
    return host.removesuffix(":443" if request.scheme == "https" else ":80")
