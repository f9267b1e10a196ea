"""The entrance's pages and answers, over arenas whose state is set and a clock that stands still."""

import gzip
import json

import pytest
from werkzeug.test import Client

from laser_bot_battle.names import Game
from server.entrance.app import AT_ONCE, create_entrance
from server.entrance.arenas import Arenas
from server.entrance.seen import Seen
from server.entrance.settings import Settings
from server.store.results import Results

BASE = "http://arena.example"


class Hall:
    """The entrance of arena.example to `count` arenas; the first has two free robots, of the others nobody hears."""

    def __init__(self, tmp_path, count=2):
        names = " ".join(f"hall{number}=:{30000 + number}" for number in range(count))
        environ = {"LASERBOT_DOMAIN": "arena.example", "LASERBOT_ARENAS": names, "LASERBOT_DATA": str(tmp_path)}
        settings = Settings.from_env(environ)
        self.now = 1000.0
        self.arenas = Arenas(settings.arenas)
        self.arenas.hear("hall0", Seen(Game.STOPPED, 2, 1, 0, False, frozenset(("Bo",))), self.now)
        self.application = create_entrance(settings, self.arenas, Results(settings.database), lambda: self.now)

    def get(self, path, **headers):
        return Client(self.application).get(path, base_url=BASE, headers=headers)

    def play(self, origin=BASE, **fields):
        return Client(self.application).post("/play", base_url=BASE, headers={"Origin": origin}, data=fields)


@pytest.fixture
def hall(tmp_path):
    return Hall(tmp_path)


def test_the_page_has_a_form_and_all_results_but_no_tournament(hall):
    page = hall.get("/")
    assert page.status_code == 200
    assert 'id="username"' in page.text
    assert "ws://" not in page.headers["Content-Security-Policy"]
    assert '"/tournament"' not in hall.get("/results").text


@pytest.mark.parametrize("language", ["en", "de", "it"])
def test_the_page_speaks_every_language(hall, language):
    assert f'<html lang="{language}"' in hall.get("/", **{"Accept-Language": language}).text


def test_a_newcomer_is_told_where_to_go_and_the_arena_who_comes(hall):
    answer = hall.play(name="Jörg Lee", avatar="3")
    assert answer.json == {"status": "OK", "arena": "hall0", "address": ":30000", "waiting": None}
    sent = answer.headers.getlist("Set-Cookie")
    assert [line.partition(";")[0] for line in sent] == ["laserbot_name=3.J%C3%B6rg%20Lee", "laserbot_play=1"]
    assert all("Domain=arena.example" in line for line in sent)


@pytest.mark.parametrize(
    ("fields", "status"),
    [
        ({}, "BAD_NAME"),
        ({"name": "<b>"}, "BAD_NAME"),
        ({"name": "Ann", "avatar": "9"}, "BAD_NAME"),
        ({"name": "operator"}, "RESERVED_NAME"),
    ],
)
def test_a_bad_wish_changes_nothing(hall, fields, status):
    answer = hall.play(**fields)
    assert (answer.status_code, answer.json) == (400, {"status": status})
    assert "Set-Cookie" not in answer.headers


def test_without_an_arena_the_newcomer_is_told_so(hall):
    hall.now += 60
    assert (hall.play(name="Ann").status_code, hall.play(name="Ann").json) == (503, {"status": "NO_ARENAS"})


def test_another_web_site_sends_nobody(hall):
    assert hall.play(name="Ann", origin="http://evil.example").status_code == 403


def test_one_address_cannot_send_without_end(hall):
    answers = [hall.play(name="Ann") for _ in range(AT_ONCE + 1)]
    assert [answer.status_code for answer in answers] == [200] * AT_ONCE + [429]


def test_everybody_gets_the_state_of_all_arenas(hall):
    told = hall.get("/arenas.json")
    assert told.json == {
        "arenas": [
            {"name": "hall0", "address": ":30000", "state": "stopped", "free": 2, "players": 1, "waiting": 0},
            {"name": "hall1", "address": ":30001", "state": "away"},
        ]
    }
    assert told.headers["Cache-Control"] == "no-cache"


def test_who_knows_the_state_already_is_not_told_again(hall):
    tag = hall.get("/arenas.json").headers["ETag"]
    assert hall.get("/arenas.json", **{"If-None-Match": tag}).status_code == 304
    hall.now += 60
    changed = hall.get("/arenas.json", **{"If-None-Match": tag})
    assert changed.status_code == 200
    assert [arena["state"] for arena in changed.json["arenas"]] == ["away", "away"]


def test_a_long_list_is_compressed_for_who_can_read_that(tmp_path):
    hall = Hall(tmp_path, 50)
    plain, packed = hall.get("/arenas.json"), hall.get("/arenas.json", **{"Accept-Encoding": "gzip"})
    assert packed.headers["Content-Encoding"] == "gzip"
    assert json.loads(gzip.decompress(packed.data)) == plain.json
    assert len(plain.json["arenas"]) == 50


def test_without_a_database_only_the_results_are_away(hall):
    assert hall.get("/results/leaderboard").status_code == 503
    assert hall.get("/").status_code == 200


def test_what_is_nowhere_has_a_page_of_its_own(hall):
    assert "Error 404" in hall.get("/home").text
