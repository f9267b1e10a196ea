"""The header Host, looked at before Flask does: some values of it make routing fail with a traceback."""

import json
import logging
import re
from collections.abc import Iterable
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

_log = logging.getLogger(__name__)

_LABEL = r"[A-Za-z0-9_](?:[A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?"
_HOST = re.compile(rf"(?:{_LABEL}(?:\.{_LABEL})*\.?|\[[0-9A-Fa-f:.]{{2,45}}\])(?::[0-9]{{1,5}})?")
_MAX_HOST = 260  # characters, the port included

_REFUSAL = json.dumps({"error": "the header Host names no host", "status": "ERROR"}).encode()


def is_valid_host(host: str) -> bool:
    """Whether that can stand in a header Host: a name, an IPv4 address or an IPv6 address in brackets; with a port."""
    try:
        host.encode("ascii").decode("idna")
    except UnicodeError:
        return False
    return len(host) <= _MAX_HOST and _HOST.fullmatch(host) is not None


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
