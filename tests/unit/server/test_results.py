"""What was played, as pages, JSON and CSV, over a real database file with battles that a referee decided."""

import csv
import io
import json
import re
import sqlite3
from contextlib import closing
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from flask import Flask
from sqlalchemy import URL

from server.game import tournament_desk
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.robot import HIT_INTERVAL
from server.game.rules import Rules
from server.pages.results import create_results
from server.store.clocks import Clocks
from server.store.course import courses
from server.store.database import Database
from server.store.results import Results
from server.web.settings import Settings
from tests.support.polling import until
from tests.support.site import whole_site

EPOCH = 1_740_000_000  # what the wall's clock is ahead of the match's
SUM = {"shots": 0, "kills": None, "accuracy": None}
UNKNOWN = {"team": 0, **SUM}  # plain light without shots does not tell whose it was
ROUTES = (
    "/results",
    "/results.json",
    "/results.csv",
    "/results/1",
    "/results/1.json",
    "/results/leaderboard",
    "/results/leaderboard.json",
    "/results/leaderboard.csv",
    "/tournament",
    "/tournament.json",
    "/tournament.csv",
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "laserbot.db"


@pytest.fixture
def keep_of(file):
    """Writes what a match has decided since the last time."""

    def write(match) -> None:
        database = Database(
            URL.create("sqlite", database=str(file)),
            clocks=Clocks(wall=lambda: match.now + EPOCH, monotonic=lambda: match.now),
        )
        database.open()
        database.record(match.referee.take_journal(), match.referee.saved(match.now))
        until(lambda: saved_at(file) == match.now + EPOCH, 10, "it is written")
        database.close()

    return write


@pytest.fixture
def keep(keep_of, match):
    return lambda: keep_of(match)


def change(file: Path, statement: str, *values: object) -> None:
    """By hand, as docs/results.md says it."""
    with closing(sqlite3.connect(file)) as connection, connection:
        connection.execute(statement, values)
        connection.execute("DELETE FROM standings")
        connection.execute("UPDATE battles SET tallied = false")


def saved_at(file: Path) -> float | None:
    with closing(sqlite3.connect(file)) as connection:
        row = connection.execute("SELECT at FROM state").fetchone()
    return row[0] if row else None


@pytest.fixture
def played(match, keep):
    """Three battles: Zoë beats bob in 8 s; bob wins as ada leaves; the third runs."""
    match.sign_up("Zoë", "bob")
    match.ready("Zoë", "bob")
    match.wait(15)
    match.hit("Zoë", 2)
    match.wait(8 - 12 * HIT_INTERVAL)
    match.hit("bob", 10)
    match.sign_out("Zoë")
    match.sign_up("ada")
    match.ready("ada", "bob")
    match.wait(15 + 20 - HIT_INTERVAL)
    match.hit("bob", 1)
    match.sign_out("ada")
    match.sign_up("_x1")
    match.ready("_x1", "bob")
    match.wait(15 + 1)
    match.hit("bob", 3)
    keep()
    return match


@pytest.fixture
def browser(file):
    return whole_site(
        GameLoop(Referee(Rules())), Settings.from_env({"LASERBOT_DATABASE": f"sqlite:///{file}"})
    ).test_client()


def table(response) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(response.get_data().decode("utf-8-sig"))))


def test_the_list_has_the_newest_battle_first(played, browser):
    listed = browser.get("/results.json").json
    assert (listed["total"], listed["page"], listed["pages"], listed["size"]) == (3, 1, 1, 25)
    assert [(one["id"], one["number"], one["running"], one["cause"]) for one in listed["battles"]] == [
        (3, 3, True, None),
        (2, 2, False, "ada signed out"),
        (1, 1, False, "bob was shot down"),
    ]
    third, second, first = listed["battles"]
    assert first["seconds"] == pytest.approx(8)
    assert first["began"] == pytest.approx(EPOCH + 1015)
    assert first["fighters"] == [
        {"place": 1, "name": "Zoë", "robot": 0, "life": 80, "left": False, "hits_taken": 2, "hits_given": None}
        | {"seconds": pytest.approx(8), **UNKNOWN},
        {"place": 2, "name": "bob", "robot": 1, "life": 0, "left": False, "hits_taken": 10, "hits_given": None}
        | {"seconds": pytest.approx(8), **UNKNOWN},
    ]
    assert [(one["name"], one["place"], one["left"]) for one in second["fighters"]] == [
        ("bob", 1, False),
        ("ada", 2, True),
    ]
    assert third["seconds"] is None
    assert {one["name"] for one in third["fighters"]} == {"bob", "_x1"}


def test_the_pages_say_the_same(played, browser):
    page = browser.get("/results").text
    assert page.index("Battle 3") < page.index("Battle 2") < page.index("Battle 1")
    assert "running" in page
    assert "Zoë" in page
    battle = browser.get("/results/1").text
    assert '0:08 min. <span id="notice" lang="en">Battle over: bob was shot down.</span>' in battle
    assert battle.count("was hit") == 12
    assert "has no result" not in battle
    assert "has no result" not in browser.get("/results/3").text
    leaderboard = browser.get("/results/leaderboard").text
    assert leaderboard.index("Zoë") < leaderboard.index("ada")


def test_a_battle_that_was_cut_off_is_told_from_one_that_runs(played, browser, file):
    change(file, "DELETE FROM state")
    assert not browser.get("/results/3.json").json["running"]
    assert "cut off" in browser.get("/results").text
    assert "has no result" in browser.get("/results/3").text


def test_the_time_line_has_what_happened_in_order(played, browser):
    timeline = browser.get("/results/2.json").json["timeline"]
    assert timeline == [
        {"at": pytest.approx(20), "name": "bob", "what": "hit", "life": 90, "by": None},
        {"at": pytest.approx(20), "name": "ada", "what": "left", "life": 100, "by": None},
    ]


def test_what_was_on_the_floor_and_what_it_did_is_read_from_the_events(played, browser, file):
    assert [browser.get("/results/1.json").json[what] for what in ("places", "effects", "points")] == [[], [], []]
    spot = {"zone": "left", "kind": "shield", "x": 0.5, "y": 1.0, "radius": 0.1}
    taken = {"name": "Zoë", "robot": 0, "zone": "left", "kind": "shield", "life": 80, "seconds": 8.0}
    with closing(sqlite3.connect(file)) as connection:
        ((began,),) = connection.execute("SELECT began FROM battles WHERE id = 1").fetchall()
    held = {"name": "Zoë", "robot": 0, "points": 1, "x": 1.0, "y": 1.0, "radius": 0.3}
    edge = {"name": "Zoë", "robot": 0, "ahead": True, "behind": False}
    happened = ((1, "PickUpLaid", spot), (2, "PickedUp", taken), (3, "HillHeld", held), (4, "Fenced", edge))
    for at, kind, data in happened:
        row = began + at, 1, kind, json.dumps(data)
        change(file, "INSERT INTO events (at, battle, kind, data, arena) VALUES (?, ?, ?, ?, '')", *row)
    found = browser.get("/results/1.json").json
    (_, place), (effect,) = found["places"], found["effects"]
    assert (place["kind"], place["since"], place["until"]) == (2, pytest.approx(1), pytest.approx(2))
    assert (effect["name"], effect["what"], effect["since"]) == ("Zoë", "shield", pytest.approx(2))
    assert found["points"] == [{"at": pytest.approx(3), "name": "Zoë", "points": 1}]
    page = browser.get("/results/1").text
    assert "picked up a shield" in page and "took the hill" in page and "was stopped at the edge" in page


def test_a_battle_that_was_seen_from_above_can_be_played_again(played, browser, file):
    assert browser.get("/results/1.json").json["track"] is None
    assert 'id="replay"' not in browser.get("/results/1").text
    floor = {"width": 2.0, "height": 1.0, "walls": [[0, 0, 2, 0]]}
    for times, seen in (([0.1, 0.3], [[0.5, 0.25, 90], None]), ([0.5], [[0.6, 0.25, 90]])):
        piece = {"floor": floor, "times": times, "robots": {"0": seen}}
        change(file, "INSERT INTO tracks (battle, data) VALUES (2, ?)", json.dumps(piece))
    assert browser.get("/results/2.json").json["track"] == {
        "floor": floor,
        "times": [0.1, 0.3, 0.5],
        "robots": {"0": [[0.5, 0.25, 90], None, [0.6, 0.25, 90]]},
    }
    assert 'id="replay-floor"' in browser.get("/results/2").text
    assert 'id="replay"' not in browser.get("/results/3").text


def test_the_chart_is_as_long_as_the_battle(played, browser):
    page = browser.get("/results/1").text
    assert "M0 0.0H12.5V40.0H25.0V80.0H1000.0" in page, "hit twice at the beginning, then lived on"
    assert "V403.0H1000.0" in page, "bob died at the end"


def test_the_leaderboard_counts_what_was_won_and_taken(played, browser):
    board = browser.get("/results/leaderboard.json").json
    assert board["day"] == "all"
    assert board["players"] == [
        {"place": 1, "name": "Zoë", "battles": 1, "wins": 1, "hits_taken": 2, "hits_given": None}
        | {"seconds": pytest.approx(8), **SUM},
        {"place": 2, "name": "bob", "battles": 2, "wins": 1, "hits_taken": 11, "hits_given": None}
        | {"seconds": pytest.approx(28), **SUM},
        {"place": 3, "name": "ada", "battles": 1, "wins": 0, "hits_taken": 0, "hits_given": None}
        | {"seconds": pytest.approx(20), **SUM},
    ]


def open_tournament(match, *names: str, **options: Any) -> None:
    match.referee.operate(partial(tournament_desk.open_one, by="Ann", names=names, **options), match.now)


def call(match) -> None:
    match.referee.operate(partial(tournament_desk.call, by="Ann"), match.now)


def test_without_a_tournament_its_page_says_so(match, keep, browser):
    keep()
    assert "No tournament has been opened yet." in browser.get("/tournament").text
    assert browser.get("/tournament.json").json == {"tournament": None}
    assert table(browser.get("/tournament.csv")) == []


def test_a_tournament_is_for_everybody_to_see(match, keep, browser):
    match.sign_up("ada", "dee")
    open_tournament(match, "ada", "bob", "cy", "dee", title="The <Cup>", third=True)
    call(match)
    match.ready("ada", "dee")
    match.wait(15)
    match.hit("ada", 10)
    call(match)
    keep()
    told = browser.get("/tournament.json").json["tournament"]
    assert (told["called"], told["matches"][0]["winner"]) == (2, "dee")
    page = browser.get("/tournament").text
    assert "The &lt;Cup&gt;" in page
    assert "Final" in page
    assert "winner of match 2" in page
    rows = table(browser.get("/tournament.csv"))
    assert [row["winner"] for row in rows] == ["dee", "", "", ""]
    assert [row["third_place"] for row in rows] == ["0", "0", "1", "0"]
    assert (rows[0]["player_1"], rows[0]["wins_1"], rows[0]["wins_2"], rows[0]["how"]) == ("ada", "0", "1", "played")


def test_the_tables_of_the_groups_are_on_the_page(match, keep, browser):
    open_tournament(match, *(f"p{number}" for number in range(8)), kind="groups")
    keep()
    page = browser.get("/tournament").text
    assert page.count("<tbody>") == 2
    assert "place 1 of group 1" in page


def test_the_leaderboard_of_a_day_has_that_day_only(match, keep, browser):
    for names in (("ada", "bob"), ("cy", "dee")):
        match.start(*names)
        match.hit(names[1], 10)
        for name in names:
            match.sign_out(name)
        keep()
        match.now += 86_400
        match.wait(0.4)
        for number in range(4):
            match.register(f"/id_service_client_{number}")
    first = datetime.fromtimestamp(EPOCH + 1000).date().isoformat()

    def players(day: str) -> list[str]:
        return [one["name"] for one in browser.get(f"/results/leaderboard.json?day={day}").json["players"]]

    assert players(first) == ["ada", "bob"]
    assert players("1999-01-01") == []
    assert sorted(players("all")) == ["ada", "bob", "cy", "dee"]
    assert "on this day" in browser.get("/results/leaderboard?day=1999-01-01").text


def test_the_best_of_a_day_are_named(told, browser):
    day = datetime.fromtimestamp(EPOCH + 1000).date().isoformat()
    board = browser.get(f"/results/leaderboard.json?day={day}").json
    assert board["honours"] == [{"kind": "kills", "name": "ada", "value": 1}]
    assert "Most robots taken out" in browser.get(f"/results/leaderboard?day={day}").text
    assert browser.get("/results/leaderboard.json").json["honours"] == []
    assert "Most robots taken out" not in browser.get("/results/leaderboard").text


def test_battles_are_told_with_their_winners_in_their_order(match, keep, browser, file):
    for loser in ("bob", "ada"):
        match.start("ada", "bob")
        match.hit(loser, 10)
        match.sign_out("ada")
        match.sign_out("bob")
        keep()
    winners = Results(URL.create("sqlite", database=str(file))).winners(0, 1e11)
    assert [sorted(battle) for battle in winners] == [[("ada", True), ("bob", False)], [("ada", False), ("bob", True)]]


def test_an_aborted_battle_is_listed_and_has_no_winner(played, browser, file):
    change(file, "UPDATE battles SET counts = 0 WHERE id = 1")
    assert "aborted" in browser.get("/results").text
    assert "aborted" in browser.get("/results/1").text
    assert [one["counts"] for one in browser.get("/results.json").json["battles"]] == [True, True, False]
    assert [one["name"] for one in browser.get("/results/leaderboard.json").json["players"]] == ["bob", "ada"]


def test_pages_are_bounded_and_linked(played, browser):
    first = browser.get("/results?size=2")
    assert "page=2&amp;size=2" in first.text
    second = browser.get("/results.json?size=2&page=2").json
    assert ([one["id"] for one in second["battles"]], second["pages"]) == ([1], 2)
    assert browser.get("/results.json?size=2&page=3").status_code == 404


def test_nothing_has_been_played_yet(match, keep, browser):
    keep()
    assert "No battle has been played yet" in browser.get("/results").text
    assert browser.get("/results.json").json["battles"] == []
    assert "Nobody has finished a battle yet" in browser.get("/results/leaderboard").text
    assert browser.get("/results/1").status_code == 404


def test_the_files_are_for_spreadsheets(played, browser, file):
    change(file, "UPDATE battles SET cause = '=1+1' WHERE id = 1")
    change(file, "UPDATE fighters SET name = ? WHERE battle = 1 AND robot = 1", '-x,"y')
    response = browser.get("/results.csv")
    assert response.content_type == "text/csv; charset=utf-8"
    assert "attachment" in response.headers["Content-Disposition"]
    lines = [line for line in table(response) if line["id"] == "1"]
    assert [(line["place"], line["name"], line["cause"], line["hits_taken"], line["played"]) for line in lines] == [
        ("1", "Zoë", "'=1+1", "2", "8.0"),
        ("2", "'-x,\"y", "'=1+1", "10", "8.0"),
    ]
    assert datetime.fromisoformat(lines[0]["began"]).timestamp() == EPOCH + 1015
    board = table(browser.get("/results/leaderboard.csv"))
    assert [(line["place"], line["name"], line["wins"], line["hits_given"]) for line in board[:2]] == [
        ("1", "bob", "1", ""),
        ("2", "Zoë", "1", ""),
    ]


def test_a_cell_that_a_spreadsheet_would_work_out_is_text(played, browser, file):
    for value in ("=1", "+1", "-1", "@x", "\tx", "\rx"):
        change(file, "UPDATE fighters SET name = ?", value)
        assert {line["name"] for line in table(browser.get("/results.csv"))} == {f"'{value}"}
        assert {line["name"] for line in table(browser.get("/results/leaderboard.csv"))} == {f"'{value}"}


NO_NUMBERS = ("0", "-1", "1.5", "", "1e3", "%D9%A1", "9" * 5000, "%3Cscript%3E", "1%00", "1%0a", "x")


@pytest.mark.parametrize("path", ["/results", "/results.json", "/results.csv"])
def test_a_wrong_page_is_refused(played, browser, path):
    for query in [f"{name}={value}" for name in ("page", "size") for value in NO_NUMBERS]:
        expect_refusal(browser.get(f"{path}?{query}"), path, 400)
    expect_refusal(browser.get(f"{path}?size=501"), path, 400)
    expect_refusal(browser.get(f"{path}?page=999999"), path, 404)


@pytest.mark.parametrize("ending", ["", ".json"])
def test_an_unknown_battle_is_not_found(played, browser, ending):
    for battle in (*NO_NUMBERS, "99", "01", "99999999999999999999", "%20"):
        if battle:
            expect_refusal(browser.get(f"/results/{battle}{ending}"), f"/results/x{ending}", 404)


@pytest.mark.parametrize("ending", ["", ".json", ".csv"])
def test_a_wrong_day_is_refused(played, browser, ending):
    path = f"/results/leaderboard{ending}"
    wrong = ("2025-02-30", "2025-2-1", "20250201", "0000-01-01", "2025-01-01%00", "2025-01-01%0a", "x", "9999-12-31")
    for day in (*wrong, *NO_NUMBERS):
        if day:
            expect_refusal(browser.get(f"{path}?day={day}"), path, 400)


@pytest.mark.parametrize("day", ["0001-01-01", "1970-01-01", "9999-12-30"])
def test_the_ends_of_the_calendar_are_no_accident(played, browser, day):
    assert browser.get(f"/results/leaderboard.json?day={day}").status_code in {200, 400}


@pytest.mark.parametrize("path", ROUTES)
def test_only_reading_is_allowed(played, browser, path):
    for method in ("post", "put", "delete"):
        assert getattr(browser, method)(path).status_code == 405
    assert browser.head(path).status_code == 200


def expect_refusal(response, path: str, code: int) -> None:
    assert response.status_code == code
    assert "<script>" not in response.text
    assert "Traceback" not in response.text
    if path.endswith(".json"):
        assert set(json.loads(response.text)) == {"error"}
    elif path.endswith(".csv"):
        assert response.content_type.startswith("text/plain")
    else:
        assert "</html>" in response.text


@pytest.mark.parametrize("path", ROUTES)
def test_without_its_database_the_pages_say_so(browser, path, file):
    for make in (lambda: None, lambda: file.write_text("what is this? " * 1000)):
        make()
        response = browser.get(path)
        assert response.status_code == 503
        assert "database cannot be read" in response.text
    assert browser.get("/").status_code == 200
    assert not file.with_name("laserbot.db-wal").exists(), "reading makes nothing"


def test_results_can_be_read_while_another_program_writes(played, browser, file):
    writer = sqlite3.connect(file, isolation_level=None)
    writer.execute("BEGIN IMMEDIATE")
    writer.execute("DELETE FROM events")
    assert browser.get("/results/1.json").status_code == 200
    writer.execute("ROLLBACK")
    writer.close()


def test_who_comes_when_others_read_is_told_to_come_again(played, file):
    results = Results(URL.create("sqlite", database=str(file)))
    for _ in range(2):
        results._turns.acquire()
    crowded = Flask("crowded")
    crowded.register_blueprint(create_results(results))
    response = crowded.test_client().get("/results.json")
    assert response.status_code == 503
    assert response.headers["Retry-After"]


def test_no_session_ever_leaves_the_database(played, browser):
    """Whoever has a session's digest can sign in to rosbridge as that player."""
    for path in ROUTES:
        assert "session of" not in browser.get(path).text


def test_a_course_is_read_from_the_events():
    began = {"fighters": [{"name": "ada", "robot": 3, "avatar": 1}, {"name": "bob", "robot": 4, "avatar": 2}]}
    ada, bob = courses(
        [
            (100.0, "BattleStarted", began),
            (101.0, "Hit", {"name": "ada", "robot": 3, "life": 0}),
            (102.0, "Left", {"name": "ada", "how": "signed out"}),
            (103.0, "RobotGone", {"robot": 4}),
            (104.0, "Left", {"name": "bob", "how": "lost the robot"}),
            (105.0, "Left", {"name": "somebody else", "how": "signed out"}),
        ]
    )
    assert (ada.life, ada.hits, ada.out, ada.left) == (0, 1, 1.0, 2.0)
    assert (bob.life, bob.hits, bob.out, bob.left) == (100, 0, 3.0, 3.0)


@pytest.fixture
def told(new_match, keep_of):
    """A battle of two teams by coded light, in which all is known."""
    match = new_match(rules=Rules(light="coded", teams=2, friendly_fire=True, hit_damage=50))
    match.start("ada", "bob", "cy")
    for shooter, victim in ((0, 1), (0, 2), (0, None), (1, 0), (0, 1)):
        match.wait(0.5)
        match.referee.shot(shooter, match.now)
        if victim is not None:
            assert match.referee.shot_hit(victim, shooter, 0, match.now, shots_told=True)
    keep_of(match)
    return match


def test_who_shot_whom_kills_and_accuracy_are_told(told, browser):
    """ada and cy are a team, so that ada's hit on cy is nothing to be proud of."""
    fields = ("name", "place", "team", "shots", "hits_given", "kills", "accuracy")
    (battle,) = browser.get("/results.json").json["battles"]
    assert [tuple(fighter[field] for field in fields) for fighter in battle["fighters"]] == [
        ("ada", 1, 1, 4, 2, 1, 0.5),
        ("cy", 1, 1, 0, 0, 0, None),
        ("bob", 3, 2, 1, 1, 0, 1.0),
    ]
    listed = browser.get("/results").text
    assert re.findall(r'class="figures">(.*?)<', listed) == [
        "Life 50, 2 hits (50%), 1 taken out",
        "Life 50, 0 hits",
        "Life 0, 1 hit (100%)",
    ]
    shown = browser.get("/results/1")
    assert "was hit by ada" in shown.text
    assert "team Red" in shown.text
    assert "50%" in shown.text
    assert [(one["name"], one["by"]) for one in browser.get("/results/1.json").json["timeline"]] == [
        ("bob", "ada"),
        ("cy", "ada"),
        ("ada", "bob"),
        ("bob", "ada"),
    ]
    board = browser.get("/results/leaderboard.json").json["players"]
    assert [(one["name"], one["hits_given"], one["kills"], one["shots"], one["accuracy"]) for one in board] == [
        ("ada", 2, 1, 4, 0.5),
        ("cy", 0, 0, 0, None),
        ("bob", 1, 0, 1, 1.0),
    ]
    assert "50%" in browser.get("/results/leaderboard").text
    (line, *_) = table(browser.get("/results.csv"))
    assert (line["team"], line["shots"], line["hits_given"], line["kills"], line["accuracy"]) == (
        "1",
        "4",
        "2",
        "1",
        "0.5",
    )
    assert table(browser.get("/results/leaderboard.csv"))[0]["accuracy"] == "0.5"


def test_a_course_knows_what_was_given_only_if_all_hits_tell():
    began = {"fighters": [{"name": name, "robot": n, "avatar": 0} for n, name in enumerate(("ada", "bob"))]}
    hits = [(101.0, "Hit", {"name": "ada", "robot": 0, "life": 90, "by": "bob"})]
    ada, bob = courses([(100.0, "BattleStarted", began), *hits])
    assert (ada.given, bob.given, bob.kills, [change.by for change in ada.changes]) == (0, 1, 0, ["bob"])
    ada, bob = courses([(100.0, "BattleStarted", began), *hits, (102.0, "Hit", {"name": "bob", "robot": 1, "life": 0})])
    assert (ada.given, bob.given, ada.kills) == (None, None, None)
