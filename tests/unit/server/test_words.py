"""Which language and which colours a visitor gets, and how words come into a page."""

import json
import re

import pytest

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web import words
from server.web.settings import Settings
from tests.support.site import whole_site

CHOSEN = re.compile(r'<html lang="(\w*)"(?: data-theme="(\w*)")?>')


@pytest.fixture(scope="module")
def app():
    return whole_site(GameLoop(Referee(Rules())), Settings.from_env({}))


def look(app, accept: str | None = None, **cookies: str) -> tuple[str, str]:
    """The language and the colours of a page."""
    browser = app.test_client()
    for name, value in cookies.items():
        browser.set_cookie(f"laserbot_{name}", value)
    response = browser.get("/about", headers={"Accept-Language": accept} if accept is not None else {})
    assert response.status_code == 200
    found = CHOSEN.search(response.text)
    assert found
    return found.group(1), found.group(2) or ""


@pytest.mark.parametrize(
    ("accept", "language"),
    [
        (None, "en"),
        ("it", "it"),
        ("de-CH, en;q=0.5", "de"),
        ("fr-FR, it;q=0.4, de;q=0.8", "de"),
        ("fr, es;q=0.9", "en"),
        ("DE-at", "de"),
        ("it;q=0, de;q=0.1", "de"),
        ("*", "en"),
    ],
)
def test_the_language_is_the_best_of_what_the_browser_asks_for(app, accept, language):
    assert look(app, accept) == (language, "")


HOSTILE = [
    *("", ",", ";q=", "it;q=x", "de;q=-1", "../../etc/passwd", "<script>", "\xff", "it\t;q=1e309"),
    *("en" * 5000, ",".join(["xx;q=0.1"] * 1000)),
]


@pytest.mark.parametrize("accept", HOSTILE, ids=range(len(HOSTILE)))
def test_a_hostile_question_for_a_language_gets_a_page_too(app, accept):
    language, _ = look(app, accept)
    assert language in words.LANGUAGES


def test_the_language_that_was_chosen_on_a_page_counts_more(app):
    assert look(app, "it", language="de") == ("de", "")


@pytest.mark.parametrize("value", ["fr", "", "EN", "../en", "de;it", "<b>", "e" * 3000])
def test_an_unknown_language_in_the_cookie_is_as_none(app, value):
    assert look(app, "it", language=value) == ("it", "")


@pytest.mark.parametrize(
    ("value", "theme"),
    [("dark", "dark"), ("light", "light"), ("", ""), ("pink", ""), ('"><script>', ""), ("Dark", "")],
)
def test_the_colours_are_those_chosen_or_the_devices(app, value, theme):
    assert look(app, theme=value) == ("en", theme)


def test_the_error_pages_are_in_the_visitors_language_and_colours_too(app):
    browser = app.test_client()
    browser.set_cookie("laserbot_language", "it")
    browser.set_cookie("laserbot_theme", "light")
    for path, method, text in (("/nothing", "get", "Errore 404"), ("/home", "post", "Errore 405")):
        page = getattr(browser, method)(path).text
        assert text in page
        assert '<html lang="it" data-theme="light">' in page


def test_what_is_wrong_with_a_request_for_results_is_told_in_the_visitors_language(app):
    browser = app.test_client()
    browser.set_cookie("laserbot_language", "de")
    assert "page muss eine ganze Zahl von 1 bis 999999 sein." in browser.get("/results?page=x").text
    refusal = browser.get("/results.json?page=x").json
    assert refusal == {"error": "page must be a whole number from 1 to 999999."}, "programs read English"


def test_texts_are_filled_and_chosen_by_number(app):
    with app.test_request_context(headers={"Accept-Language": "de"}):
        assert words.t("results.battle", number=7) == "Kampf 7"
        assert words.text("en", "results.battle", number=7) == "Battle 7"
        assert [words.text("en", "results.hits", n=n) for n in (0, 1, 2)] == ["0 hits", "1 hit", "2 hits"]


def test_no_word_ends_the_element_that_it_stands_in(app, monkeypatch):
    text = "</script><script>alert(1)</script><!-- é"
    monkeypatch.setattr(words, "words", lambda language: {"some": {"word": text}})
    with app.test_request_context():
        embedded = words.page_words(["some"])
    assert "<" not in embedded
    assert json.loads(embedded) == {"some": {"word": text}}
