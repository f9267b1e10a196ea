"""The database: what it keeps, and that the game does not mind its faults; a file and a server alike."""

import gc
import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
from sqlalchemy import URL, create_engine, insert, make_url, select, text, update

from server.game import desk
from server.game.events import BattleStarted, Recorded
from server.game.persistence import restore
from server.game.referee import Referee
from server.store import schema, versions
from server.store.clocks import Clocks
from server.store.database import MAX_WAITING, TALLY_AGAIN, TOLD_FOR, Database, Kept
from server.store.track import Floor, Piece
from tests.support.databases import rows, taken
from tests.support.polling import until
from tests.support.postgres import Postgres, own_postgres, postgres

__all__ = ["own_postgres", "postgres"]

# pg8000 leaves the closing of a broken connection to the interpreter, which may come to it in any later test
pytestmark = pytest.mark.filterwarnings("ignore:Exception ignored in. <socket:pytest.PytestUnraisableExceptionWarning")


@pytest.fixture(autouse=True, scope="module")
def nothing_left() -> Iterator[None]:
    """No test of another module meets what is left of this one's connections."""
    yield
    gc.collect()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "new folder" / "game.db"


@pytest.fixture(params=["SQLite", "PostgreSQL"])
def url(request: pytest.FixtureRequest, file: Path, postgres: Postgres) -> URL:
    """Of an empty database."""
    if request.param == "SQLite":
        return URL.create("sqlite", database=str(file))
    return postgres.new_database()


@pytest.fixture
def open_(match) -> Iterator[Callable[[URL], tuple[Database, Kept]]]:
    """Opens one, by the clock of the match, which was at 1000 s at Unix time 1 001 000 s; closed at the end. It often
    looks at its file."""
    databases: list[Database] = []

    def open_one(url: URL) -> tuple[Database, Kept]:
        clocks = Clocks(wall=lambda: match.now + 1e6, monotonic=lambda: match.now)
        databases.append(Database(url, clocks=clocks, look=0.05))
        return databases[-1], databases[-1].open()

    yield open_one
    for database in databases:
        database.close()


@pytest.fixture
def opened(open_, url: URL) -> Callable[[], tuple[Database, Kept]]:
    """Opens the one at `url` (again)."""
    return lambda: open_(url)


@pytest.fixture
def opened_file(open_, file: Path) -> Callable[[], tuple[Database, Kept]]:
    """Opens the file (again)."""
    return lambda: open_(URL.create("sqlite", database=str(file)))


def played(match) -> Referee:
    """A battle that is decided, then one that runs."""
    match.start("ada", "bob")
    match.hit("bob", 10)
    match.ready("ada", "bob")
    match.wait(15)
    match.hit("ada", 1)
    return match.referee


def record(database: Database, match) -> None:
    """What the referee has decided since the last time."""
    database.record(match.referee.take_journal(), match.referee.saved(match.now))


def wait_until_written(database: Database) -> None:
    until(lambda: not database.problem and database.waiting == 0, 20, "all is written")


def test_a_new_database_has_nothing(opened, url):
    assert opened()[1] == Kept()
    assert rows(url, "schema") == [(versions.VERSION,)]


def test_what_was_recorded_is_there_afterwards(opened, match, url):
    database, _ = opened()
    played(match)
    record(database, match)
    database.close()
    kept = opened()[1]
    assert kept.robots == {f"/id_service_client_{number}": number for number in range(4)}
    assert kept.battles == 2
    state = restore(kept.state or {}, kept.robots, match.now, 0.0)
    assert Referee(match.rules, state).snapshot(match.now) == match.state
    battles = rows(url, "battles")
    assert [(number, cause) for _, number, _, _, cause, *_ in battles] == [(1, "bob was shot down"), (2, None)]
    assert [began for _, _, began, *_ in battles] == [pytest.approx(1_001_015), pytest.approx(1_001_031)]
    events = rows(url, "events")
    assert len([1 for _, _, battle, kind, *_ in events if kind == "Hit" and battle == 1]) == 10


def test_a_battle_that_goes_on_in_another_program_is_the_same_row(opened, match, url):
    database, _ = opened()
    played(match)
    record(database, match)
    database.close()
    database, _ = opened()
    match.hit("bob", 10)
    record(database, match)
    database.close()
    assert [(number, ended is None) for _, number, _, ended, *_ in rows(url, "battles")] == [(1, False), (2, False)]


def test_pieces_of_a_track_are_kept_with_the_newest_battle_of_their_number(opened, match, url):
    database, _ = opened()
    played(match)
    began = match.now
    record(database, match)
    for number in (1, 2, 9):
        database.keep_piece(Piece(number, Floor(2.0, 1.0, ()), [began, began + 0.25], {0: [(0.5, 0.25, 0.0), None]}))
    database.close()
    tracks = rows(url, "tracks")
    assert [battle for _, battle, _ in tracks] == [1, 2], "there is no ninth one"
    assert opened()[1].state
    engine = create_engine(url)
    with engine.connect() as connection:
        data = connection.scalars(select(schema.tracks.c.data).order_by(schema.tracks.c.id)).all()[1]
        begins = connection.scalars(select(schema.battles.c.began).order_by(schema.battles.c.id)).all()[1]
    engine.dispose()
    since = round(began + 1e6 - begins, 2)
    assert data == {
        "floor": {"width": 2.0, "height": 1.0, "walls": []},
        "times": [since, round(since + 0.25, 2)],
        "robots": {"0": [[0.5, 0.25, 0], None]},
    }


def test_pieces_wait_for_a_database_that_is_away(opened_file, file, match):
    file.parent.write_text("in the way")
    database, _ = opened_file()
    played(match)
    record(database, match)
    database.keep_piece(Piece(2, Floor(2.0, 1.0, ()), [match.now], {0: [None]}))
    until(lambda: database.problem)
    file.parent.unlink()
    wait_until_written(database)
    assert len(rows(URL.create("sqlite", database=str(file)), "tracks")) == 1


def test_ids_that_change_hands_are_kept_once(opened):
    database, _ = opened()
    database.keep_robots({"/a": 0, "/b": 1})
    database.keep_robots({"/a": 1, "/c": 0})
    database.close()
    assert opened()[1].robots == {"/a": 1, "/c": 0}


def no_database(file: Path) -> None:
    file.write_bytes(b"what is this? " * 1000)


def garbled(file: Path) -> None:
    content = file.read_bytes()
    file.write_bytes(content[:4096] + bytes(byte ^ 0x5A for byte in content[4096:]))


@pytest.mark.parametrize("spoil", [no_database, garbled])
def test_a_file_that_is_broken_is_put_aside(opened_file, file, match, caplog, spoil: Callable[[Path], None]):
    database, _ = opened_file()
    record(database, match)
    database.close()
    spoil(file)
    broken = file.read_bytes()
    database, kept = opened_file()
    assert kept == Kept()
    assert (file.parent / "game.db.broken").read_bytes() == broken
    assert "begun anew" in caplog.text
    assert not database.problem


def delete(file: Path) -> None:
    for path in file.parent.glob(f"{file.name}*"):
        path.unlink()


def delete_alone(file: Path) -> None:
    """Without what SQLite has beside it."""
    file.unlink()


def delete_folder(file: Path) -> None:
    shutil.rmtree(file.parent)


def lives(url: URL) -> list[int]:
    """That hits have left."""
    return [data["life"] for _, _, _, kind, data, _ in rows(url, "events") if kind == "Hit"]


@pytest.mark.parametrize("delete", [delete, delete_alone, delete_folder])
def test_a_file_that_is_deleted_while_nothing_happens_is_back_soon_with_all_that_was_in_it(
    opened_file, file, match, caplog, delete: Callable[[Path], None]
):
    database, _ = opened_file()
    url = URL.create("sqlite", database=str(file))
    played(match)
    record(database, match)
    wait_until_written(database)
    assert database.mishap == ""
    before = {table: rows(url, table) for table in schema.metadata.tables}
    delete(file)
    until(lambda: database.mishap, 10, "it is noticed")
    assert {table: rows(url, table) for table in schema.metadata.tables} == before
    told = f"{file} was deleted while it was open: all that was in it has been written there again"
    assert (database.mishap, database.replacements, database.problem) == (told, 1, "")
    assert [one.message for one in caplog.records if one.levelname == "ERROR"] == [told]
    match.hit("bob", 10)
    record(database, match)
    database.close()
    assert [cause for _, _, _, _, cause, *_ in rows(url, "battles")] == ["bob was shot down"] * 2
    assert len(lives(url)) == 21
    match.now += TOLD_FOR
    assert database.mishap == ""


def test_a_file_that_is_deleted_just_before_the_end_is_back_as_well(opened_file, file, match):
    database, _ = opened_file()
    played(match)
    record(database, match)
    wait_until_written(database)
    delete(file)
    match.hit("bob", 1)
    record(database, match)
    database.close()
    assert len(lives(URL.create("sqlite", database=str(file)))) == 12
    assert opened_file()[1].robots


def another(open_: Callable[[URL], tuple[Database, Kept]], file: Path) -> None:
    """A database with a robot of its own, of another ID that is taken here, and battle 7."""
    other = file.with_name("other.db")
    database, _ = open_(URL.create("sqlite", database=str(other)))
    database.keep_robots({"/guest": 9, "/stranger": 1})
    database.record([Recorded(0.0, BattleStarted(7, 300.0, ()))], {})
    wait_until_written(database)
    database.close()
    delete(file)
    other.rename(file)


def rubbish(_: object, file: Path) -> None:
    other = file.with_name("other.db")
    no_database(other)
    delete(file)
    other.rename(file)


def overwritten(_: object, file: Path) -> None:
    """In its place, after all has come from the log into the file."""
    checkpoint(file)
    no_database(file)


def emptied(_: object, file: Path) -> None:
    checkpoint(file)
    os.truncate(file, 0)


def checkpoint(file: Path) -> None:
    with closing(sqlite3.connect(file)) as connection:
        assert connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone() == (0, 0, 0)


@pytest.mark.parametrize("spoil", [another, rubbish, overwritten, emptied])
def test_another_file_in_its_place_gets_the_battle_that_runs_and_all_robots(
    open_, file, match, caplog, spoil: Callable[[object, Path], None]
):
    url = URL.create("sqlite", database=str(file))
    database, _ = open_(url)
    match.start("ada", "bob")
    match.hit("bob", 3)
    record(database, match)
    wait_until_written(database)
    spoil(open_, file)
    match.hit("bob", 2)
    record(database, match)
    until(lambda: database.mishap, 10, "it is noticed")
    wait_until_written(database)
    assert database.replacements == 1
    assert any("while it was open: what this program holds is written" in one.message for one in caplog.records)
    match.hit("bob", 5)
    record(database, match)
    database.close()
    assert lives(url) == [90, 80, 70, 60, 50, 40, 30, 20, 10, 0]
    battles = [(number, cause) for _, number, _, _, cause, *_ in rows(url, "battles")]
    assert battles == [(7, None)] * (spoil is another) + [(1, "bob was shot down")]
    assert sorted(row[1:9] for row in rows(url, "fighters")) == [
        (battle, name, robot, 0, place, life, 0, hits)
        for battle in [len(battles)]
        for name, robot, place, life, hits in [("ada", 0, 1, 100, 0), ("bob", 1, 2, 0, 10)]
    ]
    kept = open_(url)[1]
    ours = {f"/id_service_client_{number}": number for number in range(4)}
    assert kept.robots == ours | ({"/guest": 9} if spoil is another else {})
    state = restore(kept.state or {}, kept.robots, match.now, 0.0)
    assert Referee(match.rules, state).snapshot(match.now) == match.state


def test_another_file_in_its_place_gets_the_state_of_the_time_when_that_was(opened_file, file, match):
    """And all of a battle that an earlier program has begun, although nothing has happened in this one."""
    database, _ = opened_file()
    url = URL.create("sqlite", database=str(file))
    played(match)
    record(database, match)
    database.close()
    database, _ = opened_file()
    record(database, match)
    wait_until_written(database)
    at, recorded = rows(url, "state")[0][1], rows(url, "events")
    match.now += 100
    rubbish(None, file)
    until(lambda: database.mishap and not database.problem, 10, "it is noticed and done")
    assert rows(url, "state")[0][1] == at
    assert [row[3] for row in rows(url, "events")] == [kind for _, _, battle, kind, *_ in recorded if battle == 2]
    assert [number for _, number, *_ in rows(url, "battles")] == [2]


def test_a_database_of_a_newer_program_is_left_alone(opened, url, match):
    opened()[0].close()
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(update(schema.schema).values(version=99))
    engine.dispose()
    database, kept = opened()
    assert kept == Kept()
    assert "update the program" in database.problem
    assert rows(url, "robots") == []


def test_a_folder_that_cannot_be_made_does_not_stop_the_game(opened_file, tmp_path, match, caplog):
    (tmp_path / "new folder").write_text("in the way")
    database, kept = opened_file()
    assert kept == Kept()
    assert database.problem
    record(database, match)
    (tmp_path / "new folder").unlink()
    until(lambda: not database.problem, 10, "the database is written again")
    database.close()
    assert opened_file()[1].robots
    assert len([record for record in caplog.records if record.levelname == "ERROR"]) == 1


def test_a_database_that_another_program_holds_is_waited_for(opened, url, match):
    database, _ = opened()
    with taken(url):
        record(database, match)
        assert not database.problem, "nobody waits for it"
        until(lambda: database.problem, 15)
    wait_until_written(database)
    assert len(rows(url, "robots")) == 4
    assert [kind for _, _, _, kind, *_ in rows(url, "events")] == ["RobotCame", "RobotLinked"] * 4


def test_what_is_recorded_during_a_write_is_written_before_the_end(opened, url, match):
    database, _ = opened()
    with taken(url):
        record(database, match)
        until(lambda: not database._waiting, 5, "it is being written")
        match.sign_up("ada")
        record(database, match)
    database.close()
    assert "SignedUp" in {kind for _, _, _, kind, *_ in rows(url, "events")}


def test_a_server_that_is_away_holds_nothing_up(open_, match):
    """Nothing listens on port 1."""
    database, kept = open_(make_url("postgresql+pg8000://u:secret@127.0.0.1:1/game"))
    assert kept == Kept()
    assert "Can't create a connection to host 127.0.0.1 and port 1" in database.problem
    assert "refused" in database.problem


def test_a_password_that_is_wrong_is_told_in_the_servers_words(open_, postgres: Postgres, caplog):
    database, kept = open_(postgres.new_database().set(password="of another"))
    assert kept == Kept()
    assert database.problem == 'password authentication failed for user "laserbot"'
    assert "of another" not in caplog.text


def test_a_server_that_is_just_starting_is_waited_for(own_postgres: Postgres, match):
    url = own_postgres.new_database()
    database = Database(url)
    database.open()
    record(database, match)
    wait_until_written(database)
    database.close()
    own_postgres.kill()
    again = Database(url)
    try:
        with ThreadPoolExecutor(1) as starter:
            opening = starter.submit(again.open, patience=60)
            until(lambda: again.problem, 10, "it was not there")
            assert not opening.done()
            own_postgres.start()
            assert len(opening.result().robots) == 4
        assert not again.problem
    finally:
        again.close()


@pytest.mark.parametrize("fault", ["killed", "stands still"])
def test_nothing_is_lost_or_doubled_by_a_server_that_was_away(
    open_, own_postgres: Postgres, match, fault: str, caplog
) -> None:
    url = own_postgres.new_database()
    database, _ = open_(url)
    match.start("ada", "bob")
    record(database, match)
    wait_until_written(database)
    away, back = {
        "killed": (own_postgres.kill, own_postgres.start),
        "stands still": (own_postgres.pause, own_postgres.resume),
    }[fault]
    away()
    try:
        for _ in range(4):
            match.hit("bob")
            record(database, match)
        assert not database.problem, "nobody waits for it"
        until(lambda: database.problem, 15, "it says why")
    finally:
        back()
    match.hit("bob")
    record(database, match)
    wait_until_written(database)
    lives = [data["life"] for _, _, _, kind, data, _ in rows(url, "events") if kind == "Hit"]
    assert lives == [90, 80, 70, 60, 50]
    assert len(rows(url, "state")) == 1
    assert [number for _, number, *_ in rows(url, "battles")] == [1]
    assert len([one for one in caplog.records if one.levelname == "ERROR"]) == 1


def test_an_answer_that_is_lost_on_its_way_doubles_nothing(opened, url, match, monkeypatch):
    """The transaction is committed; then the connection breaks, twice."""
    database, _ = opened()
    transaction = database._transaction
    answers = [False, False]

    @contextmanager
    def lost() -> Iterator[Any]:
        with transaction() as connection:
            yield connection
        if answers:
            answers.pop()
            raise OSError("the connection is broken")

    match.start("ada", "bob")
    monkeypatch.setattr(database, "_transaction", lost)
    record(database, match)
    until(lambda: database.problem, 10)
    match.hit("bob", 10)
    record(database, match)
    wait_until_written(database)
    kinds = [kind for _, _, _, kind, *_ in rows(url, "events")]
    assert (kinds.count("BattleStarted"), kinds.count("Hit"), kinds.count("BattleEnded")) == (1, 10, 1)
    [(_, _, _, ended, cause, *_)] = rows(url, "battles")
    assert (ended is None, cause) == (False, "bob was shot down")


def test_what_fails_after_a_lost_answer_is_not_taken_for_committed(opened, url, match, monkeypatch):
    database, _ = opened()
    transaction = database._transaction
    faults = ["rolled back", "rolled back", "committed"]  # the last one first

    @contextmanager
    def failing() -> Iterator[Any]:
        with transaction() as connection:
            yield connection
            if faults and faults[-1] == "rolled back":
                faults.pop()
                raise OSError("the connection is broken")
        if faults:
            faults.pop()
            raise OSError("the connection is broken")

    match.sign_up("ada")
    record(database, match)
    wait_until_written(database)
    match.sign_up("bob")
    monkeypatch.setattr(database, "_transaction", failing)
    record(database, match)
    until(lambda: len(faults) == 1, 20, "what was committed is found, and the rest fails")
    match.ready("ada", "bob")
    match.wait(15)
    match.hit("bob")
    record(database, match)
    wait_until_written(database)
    kinds = [kind for _, _, _, kind, *_ in rows(url, "events")]
    assert (kinds.count("BattleStarted"), kinds.count("Hit")) == (1, 1)


def test_what_could_not_be_read_at_the_start_is_told_before_anything_is_written_over_it(
    opened, url, match, monkeypatch
):
    database, _ = opened()
    record(database, match)
    wait_until_written(database)
    database.close()
    found: list[Kept] = []
    with monkeypatch.context() as away:
        away.setattr(Database, "_load", Mock(side_effect=OSError("it is away")))
        late, kept = opened()
        assert kept == Kept()
        late.found = found.append
    late.record([], {"newer": True})
    until(lambda: rows(url, "state")[0][2].get("newer"), 20)
    assert len(found[0].robots) == 4
    assert found[0].state is not None


def test_events_are_kept_without_what_only_the_game_may_know(opened, url, match):
    database, _ = opened()
    match.referee.sign_up("ada", "digest of ada", 0, match.now, address="10.9.8.7")
    match.referee.add_robot("/keyed", match.now, key="digest of a key", address="10.9.8.6")
    record(database, match)
    wait_until_written(database)
    kept = str(rows(url, "events"))
    assert "ada" in kept
    assert not any(secret in kept for secret in ("digest of", "10.9.8."))


def test_what_waits_for_a_database_is_bounded(opened_file, tmp_path, match):
    (tmp_path / "new folder").write_text("in the way")
    database, _ = opened_file()
    journal = match.referee.take_journal()
    for _ in range(3 * MAX_WAITING // len(journal)):
        database.record(journal, {"game": 0})
    assert database.waiting <= 2 * MAX_WAITING, "as many may be in the thread's hands"


def test_an_older_database_is_brought_to_this_version(opened, url, monkeypatch, match):
    """As if this program had been one version further."""
    opened()[0].close()
    step = lambda connection: connection.execute(insert(schema.robots).values(caller="/x", robot=5))  # noqa: E731
    monkeypatch.setattr(versions, "STEPS", (*versions.STEPS, step))
    monkeypatch.setattr(versions, "VERSION", versions.VERSION + 1)
    assert opened()[1].robots == {"/x": 5}
    engine = create_engine(url)
    with engine.begin() as connection:
        assert connection.scalar(select(schema.schema.c.version)) == versions.VERSION
    engine.dispose()
    assert opened()[1].robots == {"/x": 5}, "once only"


# as version 1 made them
VERSION_1 = """
CREATE TABLE schema (version INTEGER NOT NULL);
CREATE TABLE robots (caller VARCHAR(255) NOT NULL, robot INTEGER NOT NULL, PRIMARY KEY (caller), UNIQUE (robot));
CREATE TABLE battles (id INTEGER NOT NULL, number INTEGER NOT NULL, began FLOAT NOT NULL, ended FLOAT, cause TEXT,
    result JSON, PRIMARY KEY (id));
CREATE TABLE events (id INTEGER NOT NULL, at FLOAT NOT NULL, battle INTEGER, kind VARCHAR(32) NOT NULL,
    data JSON NOT NULL, PRIMARY KEY (id), FOREIGN KEY(battle) REFERENCES battles (id));
CREATE INDEX ix_events_battle ON events (battle);
CREATE TABLE state (id INTEGER NOT NULL, at FLOAT NOT NULL, data JSON NOT NULL, PRIMARY KEY (id));
INSERT INTO schema VALUES (1);
INSERT INTO robots VALUES ('/a', 7);
INSERT INTO battles VALUES (1, 5, 100.0, 130.0, 'bob was shot down', '[
    {"name": "ada", "robot": 0, "life": 60, "avatar": 2, "place": 1, "left": false},
    {"name": "bob", "robot": 1, "life": 0, "avatar": 3, "place": 2, "left": false}]');
INSERT INTO events VALUES (1, 90.0, NULL, 'SignedUp', '{"name": "ada", "robot": 0, "session": "s", "avatar": 2}');
INSERT INTO events VALUES (2, 100.0, 1, 'BattleStarted', '{"battle": 5, "seconds": 300.0, "fighters": [
    {"name": "ada", "robot": 0, "avatar": 2}, {"name": "bob", "robot": 1, "avatar": 3}]}');
INSERT INTO events VALUES (3, 110.0, 1, 'Hit', '{"name": "ada", "robot": 0, "life": 60}');
INSERT INTO events VALUES (4, 125.0, 1, 'Hit', '{"name": "bob", "robot": 1, "life": 0}');
"""


def test_a_database_of_version_1_gets_its_fighters(open_, tmp_path: Path):
    file = tmp_path / "old.db"
    old = sqlite3.connect(file)
    old.executescript(VERSION_1)
    old.close()
    url = URL.create("sqlite", database=str(file))
    _, kept = open_(url)
    assert kept.robots == {"/a": 7}
    assert kept.battles == 5
    assert rows(url, "schema") == [(versions.VERSION,)]
    assert [row[1:] for row in rows(url, "fighters")] == [
        (1, "ada", 0, 2, 1, 60, 0, 1, 30.0, 0, None, None, None),
        (1, "bob", 1, 3, 2, 0, 0, 1, 25.0, 0, None, None, None),
    ]
    assert [row.counts for row in rows(url, "battles")] == [1], "it counts"
    new = file.with_name("new.db")
    open_(URL.create("sqlite", database=str(new)))
    assert indexes(file) == indexes(new)


def test_a_database_of_version_2_learns_who_has_shot_and_stays_of_that_version(opened, url, match):
    """So that the older program can be put back."""
    database, _ = opened()
    played(match)
    record(database, match)
    database.close()
    engine = create_engine(url)
    with engine.begin() as connection:
        for column in ("team", "shots", "given", "kills"):
            connection.execute(text(f"ALTER TABLE fighters DROP COLUMN {column}"))
    engine.dispose()
    database, kept = opened()
    assert kept.battles == 2
    assert rows(url, "schema") == [(2,)]
    assert {row[-4:] for row in rows(url, "fighters")} == {(None,) * 4}
    match.referee.shot(0, match.now)
    match.hit("ada", 9)
    record(database, match)
    database.close()
    assert [row[-4:] for row in rows(url, "fighters")][-2:] == [(0, 1, None, None), (0, 0, None, None)]


def test_what_forgetting_a_player_spoilt_in_earlier_programs_is_told_and_mended(opened, url, match, caplog):
    database, _ = opened()
    for wish in (
        partial(desk.change_rules, changes={"light": "coded", "hit_damage": 20}),
        partial(desk.set_words, words=["idiot", "damn"]),
        partial(desk.ban, name="eve"),
    ):
        match.referee.operate(partial(wish, by="Ann"), match.now)
    record(database, match)
    database.close()
    assert opened()[1].state["rules"] == {"light": "coded", "hit_damage": 20}
    assert not caplog.records
    spoil_state(url, {"rules": {"light": "player 1", "hit_damage": 20}, "words": ["player 2", "damn"]})
    state = opened()[1].state
    assert [one.getMessage() for one in caplog.records] == [
        "found in the database: the rule light was 'player 1', but light must be one of plain, coded: it is as "
        "configured again",
        "found in the database: 1 of the words that names may not contain had become names of forgotten players: "
        "taken out, to be added again",
    ]
    assert (state["rules"], state["words"], state["banned"]) == ({"hit_damage": 20}, ["damn"], ["eve"])
    assert not Referee(match.rules, restore(state, {}, match.now, 0.0)).snapshot(match.now).coded


@pytest.mark.parametrize("nonsense", [{"rules": 3}, {"words": "damn"}, {"banned": None}])
def test_a_state_that_is_none_is_no_fault_of_the_database(opened, url, match, nonsense):
    database, _ = opened()
    record(database, match)
    database.close()
    spoil_state(url, nonsense)
    database, kept = opened()
    assert not database.problem
    assert len(kept.robots) == 4


def spoil_state(url: URL, news: dict[str, Any]) -> None:
    engine = create_engine(url)
    with engine.begin() as connection:
        data = connection.scalars(select(schema.state.c.data)).one()
        connection.execute(update(schema.state).values(data=data | news))
    engine.dispose()


def test_a_database_without_tracks_gets_them(opened, url, match):
    """They came later; an older program passes over them, so they need no version of their own."""
    opened()[0].close()
    engine = create_engine(url)
    schema.tracks.drop(engine)
    engine.dispose()
    database, _ = opened()
    played(match)
    record(database, match)
    database.keep_piece(Piece(2, Floor(2.0, 1.0, ()), [match.now], {0: [None]}))
    until(lambda: len(rows(url, "tracks")) == 1, 10)


def indexes(file: Path) -> set[str]:
    connection = sqlite3.connect(file)
    try:
        return {name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'index'")}
    finally:
        connection.close()


def test_older_battles_that_could_not_be_added_up_are_tried_again(opened_file, file, match, caplog):
    """Not at each event: what is wrong may last."""
    database, _ = opened_file()
    record(database, match)
    database.close()
    url = URL.create("sqlite", database=str(file))
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(insert(schema.battles).values(number=1, began=1.0, ended=2.0))
        connection.execute(text("CREATE TRIGGER no BEFORE UPDATE ON battles BEGIN SELECT RAISE(ABORT, 'not now'); END"))
    database, _ = opened_file()
    for name in ("ada", "bob"):
        match.sign_up(name)
        record(database, match)
        until(lambda: "(not now): tried again in 5 min" in caplog.text, 20, "it is told")
        wait_until_written(database)
    with engine.begin() as connection:
        connection.execute(text("DROP TRIGGER no"))
    engine.dispose()
    match.wait(TALLY_AGAIN)
    match.sign_up("cy")
    record(database, match)
    until(lambda: [row.tallied for row in rows(url, "battles")] == [True], 20, "it is added up")
    assert caplog.text.count("not now") == 1
