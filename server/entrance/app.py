"""The entrance's web application: its page, the way to an arena, and the results of all."""

import gzip
import json
import threading
import time
import unicodedata
from collections.abc import Callable, Iterable
from hashlib import sha256
from http import HTTPStatus
from typing import Any
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

from flask import Blueprint, Flask, Response, jsonify, render_template, request
from werkzeug.utils import redirect
from werkzeug.wrappers import Request
from werkzeug.wrappers import Response as PlainResponse

from laser_bot_battle.token_bucket import TokenBuckets
from server.entrance.arenas import Arenas
from server.entrance.settings import Settings
from server.game.users import AVATARS, is_reserved_name, is_valid_name
from server.pages.kept import KeptAnswers
from server.pages.results import create_results
from server.store.results import Results
from server.web.app import create_base
from server.web.assets import asset, with_assets
from server.web.hosts import as_asked, with_valid_host
from server.web.sessions import remember_name, send_to_play
from server.web.visitors import visitor_mark

TOLD = "/arenas.json"
AT_ONCE, PERIOD = 50, 0.1  # newcomers of one address, which a hall may share, and s for each further one
_FRESH = 0.5  # s for which everybody gets the same answer
_LEAST = 1000  # bytes; a shorter answer is not compressed


def create_entrance(
    settings: Settings, arenas: Arenas, results: Results, clock: Callable[[], float] = time.monotonic
) -> WSGIApplication:
    """All that the entrance answers."""
    app = create_app(settings, arenas, results, clock)
    kept = KeptAnswers(app, results.mark)
    return as_asked(with_valid_host(_Told(kept, arenas, clock)), settings.proxies)


def create_app(
    settings: Settings, arenas: Arenas, results: Results, clock: Callable[[], float] = time.monotonic
) -> Flask:
    """The pages, and the one thing that a visitor may do."""
    app = create_base(settings, _create_routes(arenas, clock), create_results(results))
    app.context_processor(lambda: {"is_entrance": True})
    app.wsgi_app = with_assets(app.wsgi_app)  # type: ignore[assignment, method-assign]
    return app


def _create_routes(arenas: Arenas, clock: Callable[[], float]) -> Blueprint:
    routes = Blueprint("entrance", __name__)
    newcomers = TokenBuckets(AT_ONCE, PERIOD)

    @routes.get("/")
    def page() -> str:
        return render_template("entrance.html")

    @routes.get("/favicon.ico")
    def favicon() -> PlainResponse:
        return redirect(asset("img/favicon.png"))

    @routes.post("/play")
    def play() -> Response:
        """The arena to which the newcomer goes, whose login page then knows the name."""
        name = unicodedata.normalize("NFC", request.form.get("name", ""))
        avatar = request.form.get("avatar", "0")
        if not is_valid_name(name) or avatar not in map(str, range(AVATARS)):
            return _answer(HTTPStatus.BAD_REQUEST, status="BAD_NAME")
        if is_reserved_name(name):
            return _answer(HTTPStatus.BAD_REQUEST, status="RESERVED_NAME")
        now, visitor = clock(), visitor_mark()
        if newcomers.take(visitor, now):
            return _answer(HTTPStatus.TOO_MANY_REQUESTS, status="TOO_FAST")
        choice = arenas.send(name, visitor, now, request.form.get("arena", ""))
        if choice is None:
            return _answer(HTTPStatus.SERVICE_UNAVAILABLE, status="NO_ARENAS")
        arena = choice.arena
        response = _answer(status="OK", arena=arena.name, address=arena.public, waiting=choice.waiting)
        remember_name(response, name, int(avatar))
        send_to_play(response)
        return response

    return routes


def _answer(code: HTTPStatus = HTTPStatus.OK, **content: Any) -> Response:
    response = jsonify(content)
    response.status_code = code
    return response


class _Told:
    """The state of all arenas, which every open page asks for: written once for everybody. All else is for the
    application."""

    def __init__(self, application: WSGIApplication, arenas: Arenas, clock: Callable[[], float]) -> None:
        self._application, self._arenas, self._clock = application, arenas, clock
        self._lock = threading.Lock()
        self._made_at = -_FRESH
        self._plain = self._packed = b""
        self._tag = ""

    def __call__(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        if environ["PATH_INFO"] != TOLD or environ["REQUEST_METHOD"] not in ("GET", "HEAD"):
            return self._application(environ, start_response)
        plain, packed, tag = self._now()
        asked = Request(environ)
        is_packed = len(plain) >= _LEAST and bool(asked.accept_encodings["gzip"])
        headers = [
            ("Content-Type", "application/json"),
            ("X-Content-Type-Options", "nosniff"),
            ("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'"),
            ("Cache-Control", "no-cache"),
            ("Vary", "Accept-Encoding"),
            ("ETag", f'W/"{tag}"'),  # the same however it is packed
        ]
        if asked.if_none_match.contains_weak(tag):
            start_response("304 NOT MODIFIED", headers)
            return []
        body = packed if is_packed else plain
        headers += [("Content-Encoding", "gzip")] if is_packed else []
        start_response("200 OK", [*headers, ("Content-Length", str(len(body)))])
        return [body if environ["REQUEST_METHOD"] == "GET" else b""]

    def _now(self) -> tuple[bytes, bytes, str]:
        now = self._clock()
        with self._lock:
            if now - self._made_at >= _FRESH:
                self._made_at = now
                plain = json.dumps({"arenas": self._arenas.told(now)}).encode()
                if plain != self._plain:
                    self._plain, self._packed = plain, gzip.compress(plain, 6)
                    self._tag = sha256(plain).hexdigest()[:16]
            return self._plain, self._packed, self._tag
