"""A backup is the same file whatever database it is of: it comes back into PostgreSQL, or into a file."""

import gc
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import URL, create_engine, text
from sqlalchemy.pool import NullPool

from server.store import backup, keeping, transfer
from server.store.backup import CopyError
from server.store.database import Database
from server.store.results import Results
from server.store.track import Floor, Piece
from tests.support.databases import rows
from tests.support.polling import until
from tests.support.postgres import Postgres, postgres
from tests.unit.server.conftest import Match

__all__ = ["postgres"]

# pg8000 leaves the closing of a broken connection to the interpreter, which may come to it in any later test
pytestmark = pytest.mark.filterwarnings("ignore:Exception ignored in. <socket:pytest.PytestUnraisableExceptionWarning")

TABLES = ("battles", "fighters", "standings", "events", "tracks", "state", "robots", "forgotten", "schema")


@pytest.fixture(autouse=True, scope="module")
def nothing_left() -> Iterator[None]:
    """No test of another module meets what is left of this one's connections."""
    yield
    gc.collect()


class Game:
    """A server's part that writes, and what was played there."""

    def __init__(self, url: URL) -> None:
        self.url = url
        self.match = Match()
        self._database = Database(url, "red")
        self._database.open()

    def fight(self, winner: str, loser: str) -> None:
        """A battle, with where its robots were."""
        self.match.start(winner, loser)
        self.write()  # the battle, to which the piece belongs
        floor = Floor(2.0, 1.0, ((0.5, 0.0, 0.5, 0.5),))
        self._database.keep_piece(
            Piece(self.match.state.battle, floor, [self.match.now], {0: [(0.5, 0.25, 0.0)], 1: [None]})
        )
        self.match.hit(loser, 10)
        self.write()

    def write(self) -> None:
        referee = self.match.referee
        self._database.record(referee.take_journal(), referee.saved(self.match.now))
        until(lambda: not self._database._saved and not self._database.problem and self._database.waiting == 0, 20)

    def close(self) -> None:
        self._database.close()


@pytest.fixture
def new(postgres: Postgres, tmp_path: Path) -> Callable[[str], URL]:
    """An empty database of that kind."""

    def make(kind: str) -> URL:
        if kind == "postgresql":
            return postgres.new_database()
        return URL.create("sqlite", database=str(tmp_path / f"{kind}.db"))

    return make


@pytest.fixture
def game() -> Iterator[Callable[[URL], Game]]:
    """Open one with the database there."""
    games: list[Game] = []

    def open_one(url: URL) -> Game:
        games.append(Game(url))
        return games[-1]

    yield open_one
    for each in games:
        each.close()


def quiet(percent: int) -> None:
    """No progress."""


def played(url: URL) -> Any:
    """All that the pages show of it."""
    with closing(Results(url)) as results:
        battles, _ = results.battles(1, 100)
        return battles, [results.battle(each.id) for each in battles], results.standings()


@pytest.mark.parametrize(
    ("first", "second"), [("postgresql", "postgresql"), ("postgresql", "file"), ("file", "postgresql")]
)
def test_the_results_of_a_battle_are_equal_before_and_after(
    first: str, second: str, new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path
) -> None:
    old = new(first)
    first_game = game(old)
    first_game.fight("ann", "bob")
    saved = tmp_path / "evening.db"
    assert keeping.save(old, saved, quiet) == saved.stat().st_size, "while it is written to"
    first_game.close()
    backup.check(saved)
    again = new(second)
    assert keeping.put_back(again, saved, quiet) == ""
    assert played(again) == played(old)
    assert len(played(again)[0]) == 1
    assert rows(old, "tracks")
    for table in TABLES:
        assert rows(again, table) == rows(old, table), table
    # and the game goes on there
    later = game(again)
    later.match.sign_up("cyd")
    later.write()
    later.close()
    assert len(rows(again, "events")) > len(rows(old, "events"))


def test_a_backup_of_a_program_that_knew_no_standings_comes_back_with_them(
    new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path
) -> None:
    old, saved = new("postgresql"), tmp_path / "evening.db"
    first_game = game(old)
    first_game.fight("ann", "bob")
    first_game.close()
    keeping.save(old, saved, quiet)
    with create_engine(f"sqlite:///{saved}", poolclass=NullPool).begin() as connection:
        for statement in (
            "DROP TABLE standings",
            "DROP INDEX battles_left_over",
            "ALTER TABLE battles DROP COLUMN tallied",
        ):
            connection.execute(text(statement))
    again = new("postgresql")
    keeping.put_back(again, saved, quiet)
    assert played(again) == played(old)
    assert [standing.name for standing in played(again)[2]] == ["ann", "bob"]


def test_what_was_there_is_kept_beside_it(
    new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path
) -> None:
    url = new("postgresql")
    first_game = game(url)
    first_game.fight("ann", "bob")
    keeping.save(url, tmp_path / "evening.db", quiet)
    first_game.match.sign_up("later")
    first_game.write()
    first_game.close()
    kept_in = [keeping.put_back(url, tmp_path / "evening.db", quiet) for _ in range(2)]
    assert kept_in == ["its schema laserbot_before", "its schema laserbot_before2"], "the first one's is not lost"
    assert "later" not in str(rows(url, "events"))
    with create_engine(url, poolclass=NullPool).connect() as connection:
        kept = connection.execute(text("SELECT 1 FROM laserbot_before.events")).all()
    assert len(kept) > len(rows(url, "events"))


def test_nothing_is_put_back_under_a_server(
    new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path
) -> None:
    url = new("postgresql")
    first_game = game(url)
    first_game.fight("ann", "bob")
    keeping.save(url, tmp_path / "evening.db", quiet)
    there = rows(url, "events")
    with pytest.raises(CopyError, match=r"in use from 127\.0\.0\.1: stop the web servers of all arenas first"):
        keeping.put_back(url, tmp_path / "evening.db", quiet)
    first_game.close()
    assert rows(url, "events") == there


def test_only_a_sound_file_of_ours_is_put_back(
    new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path
) -> None:
    url, wrong = new("postgresql"), tmp_path / "wrong.db"
    with pytest.raises(CopyError, match="there is no file"):
        keeping.put_back(url, wrong, quiet)
    wrong.write_text("what is this? " * 1000)
    with pytest.raises(CopyError, match="not a database"):
        keeping.put_back(url, wrong, quiet)
    with pytest.raises(CopyError, match="there is no database of LaserBot Battle there"):
        keeping.save(url, tmp_path / "new.db", quiet)
    assert [path.name for path in tmp_path.iterdir()] == ["wrong.db"]


def test_another_version_is_left_alone(new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path) -> None:
    url = new("postgresql")
    game(url).close()
    with create_engine(url, poolclass=NullPool).begin() as connection:
        connection.execute(text("UPDATE schema SET version = 99"))
    with pytest.raises(CopyError, match="it is of version 99"):
        keeping.save(url, tmp_path / "new.db", quiet)
    assert list(tmp_path.iterdir()) == []


def test_a_copy_that_fails_half_way_changes_nothing(
    new: Callable[[str], URL], game: Callable[[URL], Game], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = new("postgresql")
    first_game = game(url)
    first_game.fight("ann", "bob")
    first_game.close()
    keeping.save(url, tmp_path / "evening.db", quiet)
    there = rows(url, "events")
    monkeypatch.setattr(
        transfer, "_count", lambda connection, table: 0 if connection.dialect.name == "postgresql" else 1
    )
    with pytest.raises(CopyError, match="1 rows were read, and 0 are in the copy"):
        keeping.put_back(url, tmp_path / "evening.db", quiet)
    assert rows(url, "events") == there
