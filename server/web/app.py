"""The web application (manual 3.1.3): pages, error pages and the rules that hold for every request."""

from flask import Blueprint, Flask, Response, abort, make_response, redirect, render_template, request
from werkzeug.exceptions import HTTPException, MethodNotAllowed, NotFound
from werkzeug.wrappers import Response as WerkzeugResponse

from laser_bot_battle.hosts import policy_source
from laser_bot_battle.names import FRONT_HEADER
from server.game.loop import GameLoop
from server.store.results import Results
from server.web import operator_api
from server.web.api import cookie_session, create_api, reply
from server.web.assets import asset, compress_page, with_assets
from server.web.hosts import request_host, with_valid_host
from server.web.results import create_results
from server.web.settings import Settings
from server.web.visitors import PROXIES
from server.web.words import add_words

_MAX_BODY = 16 * 1024  # bytes; the longest honest form has about 100


def create_app(game: GameLoop, settings: Settings, *more: Blueprint) -> Flask:
    """The WSGI application that serves `game`, with `more` routes than those of players and robots."""
    app = Flask(__name__, static_folder=None)
    app.config[PROXIES] = settings.proxies
    app.jinja_env.globals["asset"] = asset
    add_words(app)
    api = create_api(game)
    for blueprint in (api, create_results(Results(settings.database)), *more):
        app.register_blueprint(blueprint)
    app.wsgi_app = with_valid_host(with_assets(app.wsgi_app))  # type: ignore[assignment, method-assign]

    @app.get("/")
    def index() -> str:
        return render_template("index.html")

    @app.get("/home")
    def home() -> str:
        return render_template("home.html")

    @app.get("/about")
    def about() -> str:
        return render_template("about.html")

    @app.get("/favicon.ico")
    def favicon() -> WerkzeugResponse:
        return redirect(asset("img/favicon.png"))

    @app.context_processor
    def page_variables() -> dict[str, object]:
        return {
            "front": FRONT_HEADER in request.headers,
            "rosbridge_port": settings.rosbridge_port,
            "relay_port": settings.relay_port,
            "view_port": settings.view_port,
        }

    @app.before_request
    def refuse_other_sites() -> Response | None:
        """A form on another web site may POST to us; browsers then say where it comes from."""
        origin = request.headers.get("Origin")
        is_harmless = request.method in {"GET", "HEAD", "OPTIONS"}
        if is_harmless or origin is None or origin.partition("://")[2] == request_host():
            return None
        return _refuse(403, "requests from other web sites are refused")

    @app.before_request
    def refuse_huge_body() -> None:
        limit = operator_api.MAX_BODY if _is_operators() else _MAX_BODY
        if (request.content_length or 0) > limit:
            abort(413)

    @app.before_request
    def note_sign_of_life() -> None:
        session = cookie_session()
        if session is not None:
            game.seen(session)

    @app.after_request
    def set_headers(response: Response) -> Response:
        headers = response.headers
        headers.setdefault("Content-Security-Policy", _page_policy(settings, request_host()))
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "same-origin"
        headers["Cache-Control"] = "no-store"
        # what pages ask for all the time would cost more to compress than it saves
        return response if request.blueprint == api.name else compress_page(response)

    @app.errorhandler(HTTPException)
    def explain(error: HTTPException) -> Response:
        """A themed page for people (404, 405, 500); JSON for what is wrong with a call of the API."""
        is_page = isinstance(error, NotFound | MethodNotAllowed) or request.blueprint != api.name
        if is_page and not _is_operators():
            return _error_page(error)
        response = _refuse(error.code or 500, error.description or error.name)
        _add_allow(response, error)
        return response

    def _is_operators() -> bool:
        return request.path.startswith(operator_api.PREFIX)

    def _refuse(code: int, error: str) -> Response:
        return operator_api.refusal(code, error) if _is_operators() else reply(code, error=error, status="ERROR")

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


def _page_policy(settings: Settings, host: str) -> str:
    """What a page may do: open WebSockets to rosbridge and the cameras' relay, and show the arena's view, on the host
    that it came from, or at the one address that the front has for all."""
    name, port = policy_source(host)
    sources = [f"{name}:{port}" for port in (settings.rosbridge_port, settings.relay_port)]
    if FRONT_HEADER in request.headers:
        sources = [name + port]  # older browsers' 'self' has no WebSockets
    sockets = [f"{scheme}://{source}" for source in sources for scheme in ("ws", "wss")]
    view = f"{name}:{settings.view_port}"
    views = "'self'" if FRONT_HEADER in request.headers else f"http://{view} https://{view}"
    frames = views if settings.view_port else "'none'"
    return (
        f"default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; frame-src {frames}; "
        f"connect-src 'self' {' '.join(sockets)}; "
        "object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'self'"
    )
