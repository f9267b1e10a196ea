"""Answers that are made once for each change."""

import threading
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from wsgiref.types import StartResponse, WSGIEnvironment

import pytest
from werkzeug.test import Client
from werkzeug.wrappers import Request, Response

from server.pages import kept
from server.pages.kept import LATEST, REST, UNMARKED, KeptAnswers


class Site:
    """An application that counts what it is asked, behind its kept answers."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.mark: object = 1
        self.now = 100.0
        self.takes = 0.0  # s
        self.status = 200
        self.cache_control = "no-cache"
        self.browser = Client(KeptAnswers(self._answer, lambda: self.mark, lambda: self.now), use_cookies=False)

    def get(self, path: str = "/results", **headers: str) -> Any:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        return self.browser.get(path, headers=named)

    def _answer(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        request = Request(environ)
        self.asked.append(request.full_path)
        self.now += self.takes
        text = f"answer {len(self.asked)} {request.headers.get('Accept-Language', '')}"
        response = Response(text, self.status, {"Cache-Control": self.cache_control})
        return response(environ, start_response)


@pytest.fixture
def site() -> Site:
    return Site()


def test_what_was_asked_before_is_not_made_again(site):
    assert site.get().text == site.get().text == "answer 1 "
    assert site.get("/results?page=2").text == "answer 2 "
    assert site.get("/results?page=2").text == "answer 2 "


def test_a_change_is_seen_at_once(site):
    site.get()
    site.mark = 2
    assert site.get().text == "answer 2 "


def test_what_takes_long_is_not_made_anew_all_the_time_while_a_battle_changes_it(site):
    site.takes = 0.5
    site.get()
    site.mark = 2
    site.now += 0.5 * REST - 0.1
    assert site.get().text == "answer 1 "
    site.now += 0.2
    assert site.get().text == "answer 2 "


def test_no_answer_is_older_than_that(site):
    site.get()
    site.now += LATEST + 0.1
    assert site.get().text == "answer 2 "


def test_where_changes_are_not_known_an_answer_is_kept_for_a_moment(site):
    site.mark = None
    site.get()
    site.now += UNMARKED
    assert site.get().text == "answer 1 "
    site.now += 0.1
    assert site.get().text == "answer 2 "


@pytest.mark.parametrize(
    "headers",
    [
        {"Accept_Language": "it"},
        {"Accept_Encoding": "gzip"},
        {"Host": "other.example"},
        {"Cookie": "laserbot_theme=dark"},
        {"Cookie": "laserbot_language=de"},
        {"X_Laserbot_Front": "yes"},
        {"X_Forwarded_Proto": "https"},
    ],
)
def test_whoever_would_get_another_page_gets_it(site, headers):
    site.get()
    site.get(**headers)
    assert len(site.asked) == 2
    site.get(Cookie="laserbot_session=secret")
    assert len(site.asked) == 2


def test_a_browser_that_has_it_is_told_so(site):
    first = site.get()
    again = site.get(If_None_Match=first.headers["ETag"])
    assert (again.status_code, again.text) == (304, "")
    site.mark = 2
    assert site.get(If_None_Match=first.headers["ETag"]).status_code == 200


def test_a_page_that_no_browser_may_keep_has_no_mark(site):
    site.cache_control = "no-store"
    assert "ETag" not in site.get().headers


def test_failures_are_not_kept(site):
    site.status = 503
    assert site.get().status_code == 503
    site.status = 200
    assert site.get().status_code == 200
    assert site.get().text == "answer 2 "


def test_head_and_get_share_an_answer(site):
    head = site.browser.head("/results")
    assert head.text == ""
    assert site.get().headers["Content-Length"] == head.headers["Content-Length"]
    assert len(site.asked) == 1


def test_posts_and_files_pass_through(site):
    for _ in range(2):
        site.browser.post("/results")
        site.get("/static/css/common.css")
    assert len(site.asked) == 4


def test_many_who_ask_at_once_wait_for_one_answer(site):
    together = threading.Barrier(4)

    def ask() -> str:
        together.wait(5)
        return site.get().text

    with ThreadPoolExecutor(4) as crowd:
        answers = [one.result() for one in [crowd.submit(ask) for _ in range(4)]]
    assert answers == ["answer 1 "] * 4


def test_what_was_not_asked_for_longest_makes_room(site, monkeypatch):
    monkeypatch.setattr(kept, "MAX_SIZE", 3 * 3000)
    for page in (1, 2, 3, 1, 4, 5):
        site.get(f"/results?page={page}")
    before = len(site.asked)
    site.get("/results?page=1")
    assert len(site.asked) == before
    site.get("/results?page=2")
    assert len(site.asked) == before + 1
