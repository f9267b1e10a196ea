"""The web applications (manual 3.1.3): the game's own, and what it has in common with that of the pages."""

from collections.abc import Iterable
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

from flask import Blueprint, Flask, Response, abort, make_response, render_template, request
from werkzeug.exceptions import HTTPException, MethodNotAllowed, NotFound
from werkzeug.wrappers import Request

from laser_bot_battle.hosts import policy_source
from laser_bot_battle.names import FRONT_HEADER
from laser_bot_battle.proxies import Asked, visitor
from server.access.own_pages import PageAddresses, Standing
from server.game.loop import GameLoop
from server.web import operator_api, operator_requests
from server.web.api import API, create_api, reply, session_of
from server.web.assets import asset, compress_page
from server.web.hosts import as_asked, request_host, with_valid_host
from server.web.routes import OwnRoutes
from server.web.sessions import DOMAIN
from server.web.settings import PageSettings, Settings
from server.web.visitors import PROXIES, VISITOR, watch_addresses
from server.web.words import add_words

_VISITOR = f"HTTP_{VISITOR.upper().replace('-', '_')}"
_MAX_BODY = 16 * 1024  # bytes; the longest honest form has about 100


def create_app(game: GameLoop, settings: Settings, *more: Blueprint, pages: WSGIApplication) -> Flask:
    """The WSGI application that serves `game`, with `more` routes than those of players and robots; for all other
    requests it asks `pages`."""
    app = create_base(settings, create_api(game), *more)
    watch_addresses(app)
    own = OwnRoutes(app)
    answer = app.wsgi_app

    def answer_or_ask(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        session = session_of(Request(environ))
        if session is not None:
            game.seen(session)  # a sign of life
        if own.has(environ["PATH_INFO"]):
            return answer(environ, start_response)
        address = visitor(environ.get("REMOTE_ADDR", ""), environ.get("HTTP_X_FORWARDED_FOR"), settings.proxies)
        return pages({**environ, _VISITOR: address}, start_response)

    app.wsgi_app = as_asked(with_valid_host(answer_or_ask), settings.proxies)  # type: ignore[assignment, method-assign]
    return app


def create_base(settings: PageSettings, *routes: Blueprint) -> Flask:
    """An application with these routes, and the rules that hold for every request."""
    own = PageAddresses(None, settings.origins)
    app = Flask(__name__, static_folder=None)
    app.config[PROXIES] = settings.proxies
    app.config[DOMAIN] = settings.domain
    app.jinja_env.globals["asset"] = asset
    add_words(app)
    for blueprint in routes:
        app.register_blueprint(blueprint)

    @app.context_processor
    def page_variables() -> dict[str, object]:
        return {
            "front": FRONT_HEADER in request.headers,
            "rosbridge_port": settings.rosbridge_port,
            "relay_port": settings.relay_port,
            "domain": settings.domain,
        }

    @app.before_request
    def refuse_other_sites() -> Response | None:
        """A form on another web site may POST to us; browsers then say where it comes from."""
        origin, host = request.headers.get("Origin"), request.headers.get("Host", "")
        is_harmless = request.method in {"GET", "HEAD", "OPTIONS"}
        authority = Asked(request.scheme, host).authority
        if is_harmless or origin is None or own.standing(origin, authority) is not Standing.FOREIGN:
            return None
        return _refuse(
            403,
            f"requests from other web sites are refused: the page is at {origin[:100]}, and asked for {host[:100]}. If "
            "it belongs to the game, behind a proxy, name its address in LASERBOT_ORIGINS",
        )

    @app.before_request
    def refuse_huge_body() -> None:
        limit = operator_api.MAX_BODY if _is_operators() else _MAX_BODY
        if (request.content_length or 0) > limit:
            abort(413)

    @app.after_request
    def set_headers(response: Response) -> Response:
        headers = response.headers
        headers.setdefault("Content-Security-Policy", _page_policy(settings, request_host()))
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "same-origin"
        headers.setdefault("Cache-Control", "no-store")
        # what pages ask for all the time would cost more to compress than it saves
        return response if request.blueprint == API else compress_page(response)

    @app.errorhandler(HTTPException)
    def explain(error: HTTPException) -> Response:
        """A themed page for people (404, 405, 500); JSON for what is wrong with a call of the API."""
        is_page = isinstance(error, NotFound | MethodNotAllowed) or request.blueprint != API
        if is_page and not _is_operators():
            return _error_page(error)
        response = _refuse(error.code or 500, error.description or error.name)
        _add_allow(response, error)
        return response

    def _is_operators() -> bool:
        return request.path.startswith(operator_api.PREFIX)

    def _refuse(code: int, error: str) -> Response:
        return operator_requests.refusal(code, error) if _is_operators() else reply(code, error=error, status="ERROR")

    def _error_page(error: HTTPException) -> Response:
        code = error.code or 500
        page = code if code in {404, 405} else 500
        response = make_response(render_template(f"errors/{page}.html"), code)
        _add_allow(response, error)
        return response

    def _add_allow(response: Response, error: HTTPException) -> None:
        if isinstance(error, MethodNotAllowed) and error.valid_methods:
            response.headers["Allow"] = ", ".join(sorted(error.valid_methods))

    return app


def _page_policy(settings: PageSettings, host: str) -> str:
    """What a page may do: open WebSockets to rosbridge and the cameras' relay on the host that it came from, or at the
    one address that the front has for all. A proxy may not tell which that is."""
    hosts = [host, *(origin.partition("://")[2] for origin in settings.origins)]
    names = list(dict.fromkeys(policy_source(host) for host in hosts))
    ports = [port for port in (settings.rosbridge_port, settings.relay_port) if port]
    sources = [f"{name}:{port}" for name, _ in names for port in ports]
    if ports and FRONT_HEADER in request.headers:
        sources = [name + port for name, port in names]  # older browsers' 'self' has no WebSockets
    sockets = [f"{scheme}://{source}" for source in dict.fromkeys(sources) for scheme in ("ws", "wss")]
    return (
        f"default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; frame-src 'none'; "
        f"connect-src 'self' {' '.join(sockets)}; "
        "object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'self'"
    )
