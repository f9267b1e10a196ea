"""The application of what people look at: pages, results and files. Whoever looks needs no game, only the database."""

from flask import Blueprint, Flask, render_template
from werkzeug.utils import redirect
from werkzeug.wrappers import Response

from server.pages.audience import Audience, create_audience
from server.pages.results import create_results
from server.pages.tournament import add_tournament
from server.pages.watch import create_watch
from server.store.results import Results
from server.web.app import create_base
from server.web.assets import asset, with_assets
from server.web.hosts import as_told
from server.web.settings import Settings


def create_pages(settings: Settings, results: Results, audience: Audience) -> Flask:
    """The WSGI application."""
    of_results = create_results(results)
    add_tournament(of_results, results, settings.arena)
    routes = _create_plain(), of_results, create_watch(settings), create_audience(audience)
    app = create_base(settings, *routes)
    app.wsgi_app = as_told(with_assets(app.wsgi_app))  # type: ignore[assignment, method-assign]
    return app


def _create_plain() -> Blueprint:
    pages = Blueprint("pages", __name__)

    @pages.get("/")
    def index() -> str:
        return render_template("index.html")

    @pages.get("/home")
    def home() -> str:
        return render_template("home.html")

    @pages.get("/about")
    def about() -> str:
        return render_template("about.html")

    @pages.get("/favicon.ico")
    def favicon() -> Response:
        return redirect(asset("img/favicon.png"))

    return pages
