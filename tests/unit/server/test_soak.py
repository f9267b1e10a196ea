"""What `make soak` finds at the end of an evening."""

from pathlib import Path

import pytest
from sqlalchemy import URL, create_engine, text

from server.store.clocks import Clocks
from server.store.database import Database
from tests.soak import records
from tests.soak.vitals import MORE_FILES, Counts, leaks


@pytest.fixture
def url(match, tmp_path: Path) -> URL:
    """Of a database with a battle that is decided."""
    url = URL.create("sqlite", database=str(tmp_path / "game.db"))
    database = Database(url, clocks=Clocks(wall=lambda: match.now + 1e6, monotonic=lambda: match.now))
    database.open()
    match.start("ada", "bob")
    match.hit("bob", 10)
    database.record(match.referee.take_journal(), match.referee.saved(match.now))
    database.close()
    return url


def change(url: URL, statement: str) -> None:
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(text(statement))
    engine.dispose()


def test_an_evening_in_order_is_found_to_be_so(url):
    assert records.battles(url) == 1
    assert not records.wrong_results(url)
    assert not records.left_over(url)


def test_a_result_that_its_events_do_not_lead_to_is_found(url):
    change(url, "DELETE FROM events WHERE kind = 'Hit'")
    assert records.wrong_results(url) == ["battle 1: its events lead to another result"]


@pytest.mark.parametrize(
    ("statement", "found"),
    [
        ("UPDATE battles SET ended = NULL", "1 battles without an end"),
        ("UPDATE fighters SET place = NULL", "2 fighters without a place"),
        ("INSERT INTO tracks (battle, data) VALUES (7, '[]')", "1 tracks of no battle"),
    ],
)
def test_a_row_that_nothing_needs_is_found(url, statement, found):
    change(url, statement)
    assert records.left_over(url) == [found]


def test_what_a_part_has_left_over_is_found_by_its_name():
    quiet = {"server.main": Counts(1, 20, 50), "server.bots": Counts(2, 2, 20)}
    assert not leaks(quiet, {**quiet, "server.main": Counts(1, 21, 50 + MORE_FILES)})
    assert leaks(quiet, {"server.main": Counts(1, 40, 50), "server.bots": Counts(3, 3, 30)}) == [
        "server.bots: 2 processes became 3",
        "server.main: 20 threads became 40",
    ]
    assert leaks(quiet, {**quiet, "server.main": Counts(1, 20, 51 + MORE_FILES)}) == [
        f"server.main: 50 open files became {51 + MORE_FILES}"
    ]
    assert leaks(quiet, {**quiet, "robot.camera": Counts(1, 1, 5)}) == ["robot.camera: 0 processes became 1"]
