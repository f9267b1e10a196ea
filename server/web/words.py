"""The pages' words in each language: server/static/words, a file per language, which the scripts of the pages use too.

A visitor's language is the one chosen on a page (a cookie), or else the best of what the browser asks for.
"""

import json
from functools import cache
from pathlib import Path
from typing import Any

from flask import Flask, g, request
from markupsafe import Markup

LANGUAGES = {"en": "English", "it": "Italiano", "de": "Deutsch"}  # the first is for everybody else
LANGUAGE_COOKIE = "laserbot_language"
THEME_COOKIE = "laserbot_theme"
_THEMES = ("light", "dark")
_FOLDER = Path(__file__).resolve().parents[1] / "static" / "words"


@cache
def words(language: str) -> dict[str, Any]:
    """{section: {key: text}} of a language; a text is a string or {"one": string, "other": string}."""
    found: dict[str, Any] = json.loads((_FOLDER / f"{language}.json").read_text())
    return found


def language() -> str:
    """The language of this request's visitor, found once: a page of results asks for it thousands of times."""
    if "language" not in g:
        g.language = _language()
    return str(g.language)


def _language() -> str:
    chosen = request.cookies.get(LANGUAGE_COOKIE, "")
    if chosen in LANGUAGES:
        return chosen
    wanted = [tag.partition("-")[0].lower() for tag, quality in request.accept_languages if quality > 0]  # best first
    return next((code for code in wanted if code in LANGUAGES), next(iter(LANGUAGES)))


def theme() -> str:
    """The colours that this request's visitor has chosen: "light", "dark" or "" for what the device prefers."""
    chosen = request.cookies.get(THEME_COOKIE, "")
    return chosen if chosen in _THEMES else ""


def t(key: str, **values: str | int) -> str:
    """The text "section.key" in the visitor's language, with its {places} filled; `n` chooses between one and many."""
    return text(language(), key, **values)


def text(language: str, key: str, **values: str | int) -> str:
    """The same in this language, for what is not written for the visitor's eyes."""
    section, _, name = key.partition(".")
    found = words(language)[section][name]
    if not isinstance(found, str):
        found = found["one" if values["n"] == 1 else "other"]
    return str(found.format(**values))


def page_words(sections: list[str]) -> Markup:
    """These sections as JSON that can stand in an HTML page."""
    text = json.dumps({name: words(language())[name] for name in sections}, ensure_ascii=False)
    return Markup(text.replace("<", "\\u003c"))  # so nothing in it ends the element that it stands in


def add_words(app: Flask) -> None:
    """Give them to the application's templates."""
    app.jinja_env.globals.update(t=t, page_words=page_words, languages=LANGUAGES)

    @app.context_processor
    def choices() -> dict[str, str]:
        return {"language": language(), "theme": theme()}
