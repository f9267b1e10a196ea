"""The game's application and that of the pages, joined in one process."""

from flask import Blueprint, Flask

from server.game.loop import GameLoop
from server.pages.app import create_pages
from server.pages.audience import Audience
from server.store.results import Results
from server.web.app import create_app
from server.web.settings import Settings


def whole_site(game: GameLoop, settings: Settings, *more: Blueprint) -> Flask:
    pages = create_pages(settings, Results(settings.database), Audience())
    return create_app(game, settings, *more, pages=pages.wsgi_app)
