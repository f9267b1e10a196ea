"""`python3 -m server.store`: backup, restore and forget, beside a writer that has the database open."""

import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import URL

from server.store.clocks import Clocks
from server.store.database import Database
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import ROOT


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "data" / "laserbot.db"


class Writer:
    """The part of a running server that writes what the match decides."""

    def __init__(self, file: Path, match) -> None:
        self._match = match
        self._file = file
        url = URL.create("sqlite", database=str(file))
        self._database = Database(url, clocks=Clocks(wall=lambda: match.now + 1e9, monotonic=lambda: match.now))
        self._database.open()

    def write(self) -> None:
        match = self._match
        match.now += 0.01  # by which what is written now is told from what is there
        self._database.record(match.referee.take_journal(), match.referee.saved(match.now))
        until(
            lambda: not self._database._waiting and rows(self._file, "SELECT at FROM state") == [(match.now + 1e9,)], 5
        )

    def close(self) -> None:
        self._database.close()


@pytest.fixture
def writer(file, match) -> Iterator[Writer]:
    """It has written a battle of ada and adam, which ada has won, and left."""
    match.start("ada", "adam")
    match.hit("adam", 10)
    match.sign_out("ada")
    match.wait(1)
    writer = Writer(file, match)
    writer.write()
    yield writer
    writer.close()


@pytest.fixture
def command(file) -> Callable[..., subprocess.CompletedProcess[bytes]]:
    def run(*words: str | Path, **options) -> subprocess.CompletedProcess[bytes]:
        environment = {"PYTHONPATH": f"{ROOT}:{ROOT}/build/python", "LASERBOT_DATA": str(file.parent)}
        environment |= options.pop("env", {})
        return subprocess.run(
            [sys.executable, "-m", "server.store", *words],
            env=environment,
            capture_output=True,
            timeout=60,
            check=False,
            **options,
        )

    return run


def rows(file: Path, query: str) -> list[tuple[object, ...]]:
    with closing(sqlite3.connect(file)) as connection:
        return connection.execute(query).fetchall()


def bytes_of(file: Path) -> bytes:
    """All that the database has on the disk. To close a file ends this process's locks on it, those of a writer too."""
    return b"".join(part.read_bytes() for part in sorted(file.parent.glob(f"{file.name}*")))


def names(file: Path) -> list[str]:
    return [str(name) for (name,) in rows(file, "SELECT name FROM fighters ORDER BY id")]


def test_a_backup_is_made_beside_a_writer_and_put_back(writer, match, command, file, tmp_path):
    saved = tmp_path / "evening.db"
    done = command("backup", saved)
    assert done.returncode == 0, done.stderr
    assert str(saved).encode() in done.stderr
    assert names(saved) == ["ada", "adam"]
    match.sign_up("cy")
    writer.write()
    writer.close()
    assert len(rows(file, "SELECT 1 FROM events")) > len(rows(saved, "SELECT 1 FROM events"))
    done = command("restore", saved)
    assert done.returncode == 0, done.stderr
    assert rows(file, "SELECT * FROM events") == rows(saved, "SELECT * FROM events")
    before = file.with_name("laserbot.db.before")
    assert (1,) in rows(before, "SELECT 1 FROM events WHERE data LIKE '%cy%'"), "nothing is thrown away"
    assert sorted(path.name for path in file.parent.iterdir()) == ["laserbot.db", "laserbot.db.before"]
    Writer(file, match).close()


def test_a_backup_by_pipe(writer, command, file):
    saved = command("backup", "-")
    assert (saved.returncode, saved.stdout[:15]) == (0, b"SQLite format 3")
    writer.close()
    file.unlink()
    assert command("restore", "-", input=saved.stdout).returncode == 0
    assert names(file) == ["ada", "adam"]
    assert [path.name for path in file.parent.iterdir()] == ["laserbot.db"]


def test_nothing_is_put_back_under_a_writer(writer, command, file, tmp_path):
    saved = tmp_path / "evening.db"
    command("backup", saved)
    done = command("restore", saved)
    assert done.returncode == 1, done.stderr
    assert b"stop the web server first" in done.stderr
    assert not file.with_name("laserbot.db.before").exists()
    assert names(file) == ["ada", "adam"]


def test_only_a_sound_database_of_ours_is_put_back(writer, command, file, tmp_path):
    writer.close()
    there = names(file)
    no_database, other, newer, cut = (tmp_path / name for name in ("a.db", "b.db", "c.db", "d.db"))
    no_database.write_text("what is this? " * 1000)
    with closing(sqlite3.connect(other)) as connection:
        connection.execute("CREATE TABLE x (y)")
    command("backup", newer)
    with closing(sqlite3.connect(newer)) as connection:
        connection.execute("UPDATE schema SET version = 99")
        connection.commit()
    cut.write_bytes(file.read_bytes()[:9000])
    for wrong, why in (
        (no_database, "not a database"),
        (other, "not one of LaserBot Battle"),
        (newer, "update the program"),
        (cut, "d.db"),
        (tmp_path / "nowhere.db", "there is no file"),
    ):
        done = command("restore", wrong)
        assert (done.returncode, why in done.stderr.decode(), b"Traceback" in done.stderr) == (1, True, False), done
    assert names(file) == there
    assert [path.name for path in file.parent.iterdir()] == ["laserbot.db"]


def test_a_broken_database_can_be_replaced(writer, command, file, tmp_path):
    command("backup", tmp_path / "evening.db")
    writer.close()
    file.write_text("what is this? " * 1000)
    done = command("restore", tmp_path / "evening.db")
    assert done.returncode == 0, done.stderr
    assert names(file) == ["ada", "adam"]


def test_a_backup_that_fails_leaves_what_was_there(writer, command, file, tmp_path):
    saved = tmp_path / "evening.db"
    saved.write_text("the last one")
    writer.close()
    file.write_text("what is this? " * 1000)
    assert command("backup", saved).returncode == 1
    assert saved.read_text() == "the last one"
    assert command("backup", tmp_path / "nowhere" / "evening.db").returncode == 1
    assert command("backup", file).returncode == 1
    file.unlink()
    assert b"there is no database" in command("backup", saved).stderr


def test_a_server_that_does_not_answer_is_named_without_its_password(command, writer, tmp_path):
    address = f"127.0.0.1:{free_port()}"
    command("backup", tmp_path / "evening.db")
    for words in (("backup", tmp_path / "new.db"), ("keep", tmp_path), ("restore", tmp_path / "evening.db")):
        done = command(*words, env={"LASERBOT_DATABASE": f"postgresql://u:secret@{address}/game"})
        assert done.returncode == 1
        assert address.encode() in done.stderr
        assert b"secret" not in done.stderr
        assert done.stderr.count(b"\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == [".lock", "data", "evening.db"]


def test_help_and_a_wrong_command(command):
    shown = command("--help")
    assert shown.returncode == 0
    for word in (b"backup", b"restore", b"forget", b"LASERBOT_DATABASE"):
        assert word in shown.stdout
    assert command().returncode == 2
    assert command("eat", "x").returncode == 2


def test_a_forgotten_player_is_nowhere_and_the_results_stay(writer, match, command, file):
    done = command("forget", "ada")
    assert done.returncode == 0, done.stderr
    assert b"player 1" in done.stderr
    assert names(file) == ["player 1", "adam"]
    assert b'"ada"' not in bytes_of(file)
    assert b"ada " not in bytes_of(file)
    assert rows(file, "SELECT data FROM events WHERE kind = 'Left'") == [
        ('{"name": "player 1", "how": "signed out", "by": ""}',)
    ]
    assert [row for row in rows(file, "SELECT result FROM battles") if '"player 1"' in str(row)]


def test_a_server_that_remembers_the_player_does_not_write_the_name_again(writer, match, command, file):
    assert match.ranking == [(1, "ada"), (2, "adam")], "the screens show it still"
    assert command("forget", "ada").returncode == 0
    match.sign_up("cy")
    writer.write()
    assert b'"ada"' not in bytes_of(file)
    assert rows(file, "SELECT digest IS NULL FROM forgotten") == [(0,)]
    match.ready("cy", "adam")  # the countdown takes the old result away
    writer.write()
    assert rows(file, "SELECT digest IS NULL FROM forgotten") == [(1,)]
    match.ready("cy", ready=False)
    match.sign_up("ada")
    writer.write()
    assert rows(file, "SELECT 1 FROM events WHERE kind = 'SignedUp' AND data LIKE '%\"ada\"%'"), "somebody new"


def test_who_fought_in_a_battle_that_runs_is_forgotten_too(match, file, command):
    match.start("ada", "bob", "cy")
    match.hit("ada", 2)
    match.sign_out("ada")
    writer = Writer(file, match)
    writer.write()
    assert command("forget", "ada").returncode == 0
    match.hit("bob", 10)
    writer.write()
    writer.close()
    assert names(file) == ["player 1", "bob", "cy"]
    assert rows(file, "SELECT place, life, hits FROM fighters WHERE name = 'player 1'") == [(3, 80, 2)]
    assert b'"ada"' not in bytes_of(file)


def test_who_plays_now_has_to_sign_out_first(writer, match, command, file):
    done = command("forget", "adam")
    assert (done.returncode, b"sign out first" in done.stderr) == (1, True)
    assert names(file) == ["ada", "adam"]
    assert rows(file, "SELECT * FROM forgotten") == []


def test_a_ban_has_to_end_first(writer, command, file):
    writer.close()
    with closing(sqlite3.connect(file)) as connection:
        connection.execute("UPDATE state SET data = json_set(data, '$.banned', json_array('ada'))")
        connection.commit()
    assert b"allow it again first" in command("forget", "ada").stderr
    assert names(file) == ["ada", "adam"]


def test_an_unknown_name_changes_nothing(writer, command, file):
    for name in ("Ada", "", "%", "\x1b[31m"):
        done = command("forget", name)
        assert done.returncode == 1
        assert b"there is nobody called" in done.stderr
    assert rows(file, "SELECT * FROM forgotten") == []
    assert names(file) == ["ada", "adam"]
