"""The web application (manual 3.1.3): pages, error pages and the rules that hold for every request."""

from flask import Flask, Response, abort, make_response, render_template, request
from werkzeug.exceptions import HTTPException, MethodNotAllowed, NotFound

from server.game.loop import GameLoop
from server.settings import Settings
from server.web.api import cookie_session, create_api, reply

_MAX_BODY = 16 * 1024  # bytes; the longest honest form has about 100

# the page opens a WebSocket to rosbridge, and shows the arena's view: same host, other ports
_PAGE_POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self' ws: wss:; "
    "object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'self'"
)


def create_app(game: GameLoop, settings: Settings) -> Flask:
    """The WSGI application that serves `game`."""
    app = Flask(__name__, static_folder="../static")
    page_policy = _PAGE_POLICY + (f"; frame-src *:{settings.view_port}" if settings.view_port else "")
    api = create_api(game)
    app.register_blueprint(api)

    @app.get("/")
    def index() -> str:
        return render_template("index.html")

    @app.get("/home")
    def home() -> str:
        return render_template("home.html")

    @app.get("/about")
    def about() -> str:
        return render_template("about.html")

    @app.context_processor
    def page_variables() -> dict[str, int | None]:
        return {"rosbridge_port": settings.rosbridge_port, "view_port": settings.view_port}

    @app.before_request
    def refuse_other_sites() -> Response | None:
        """A form on another web site may POST to us; browsers then say where it comes from."""
        origin = request.headers.get("Origin")
        if request.method == "POST" and origin is not None and origin.partition("://")[2] != request.host:
            return reply(403, error="requests from other web sites are refused", status="ERROR")
        return None

    @app.before_request
    def refuse_huge_body() -> None:
        if (request.content_length or 0) > _MAX_BODY:
            abort(413)

    @app.before_request
    def note_sign_of_life() -> None:
        session = cookie_session()
        if session is not None:
            game.seen(session)

    @app.after_request
    def set_headers(response: Response) -> Response:
        headers = response.headers
        headers.setdefault("Content-Security-Policy", page_policy)
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "same-origin"
        if request.endpoint != "static":
            headers["Cache-Control"] = "no-store"
        return response

    @app.errorhandler(HTTPException)
    def explain(error: HTTPException) -> Response:
        """A themed page for people (404, 405, 500); JSON for what is wrong with a call of the API."""
        if isinstance(error, NotFound | MethodNotAllowed) or not _is_api_call():
            return _error_page(error)
        return reply(error.code or 500, error=error.description or error.name, status="ERROR")

    def _is_api_call() -> bool:
        return request.blueprint == api.name

    def _error_page(error: HTTPException) -> Response:
        code = error.code or 500
        page = code if code in {404, 405} else 500
        response = make_response(render_template(f"errors/{page}.html"), code)
        if isinstance(error, MethodNotAllowed) and error.valid_methods:
            response.headers["Allow"] = ", ".join(sorted(error.valid_methods))
        return response

    return app
