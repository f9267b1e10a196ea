"""`python3 -m server.store keep`: a folder of backups, of which each is whole and the newest stay."""

import fcntl
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from datetime import UTC, datetime, time, timedelta
from pathlib import Path
from types import SimpleNamespace

import pytest
from sqlalchemy import URL

from server.store import backup, keeping, versions
from server.store.backup import CopyError
from server.store.database import make_engine
from tests.support.polling import until
from tests.support.programs import ROOT, Program

EVENING = datetime(2026, 11, 28, 20, 15, tzinfo=UTC)
LATER = datetime.max.replace(tzinfo=UTC) - timedelta(days=1)
ENVIRONMENT = {"PYTHONPATH": f"{ROOT}:{ROOT}/build/python"}


@pytest.fixture
def url(tmp_path: Path) -> URL:
    """An empty database of the game."""
    (tmp_path / "data").mkdir()
    url = URL.create("sqlite", database=str(tmp_path / "data" / "laserbot.db"))
    engine = make_engine(url)
    with engine.begin() as connection:
        versions.prepare(connection)
    engine.dispose()
    return url


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """For backups; also somebody else's files are in it."""
    folder = tmp_path / "backups"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    (folder / "laserbot-old.db").write_text("mine, too")
    return folder


@pytest.fixture
def keep(url: URL, folder: Path) -> Callable[..., tuple[Path, list[Path]]]:
    def run(now: datetime = EVENING, number: int = 14, into: Path = folder) -> tuple[Path, list[Path]]:
        return keeping.keep(url, into, number, now, lambda percent: None)

    return run


def names(paths: list[Path]) -> list[str]:
    return [path.name for path in paths]


def everything(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_each_is_a_sound_database_in_one_file(keep, folder: Path) -> None:
    made, _ = keep()
    assert made == folder / "laserbot-2026-11-28T201500Z.db"
    backup.check(made)
    with closing(sqlite3.connect(f"{made.as_uri()}?immutable=1", uri=True)) as connection:
        assert connection.execute("PRAGMA journal_mode").fetchone() == ("delete",)
    assert everything(folder) == [".lock", made.name, "laserbot-old.db", "notes.txt"]


def test_the_newest_stay_and_other_files_too(keep, folder: Path) -> None:
    made = [keep(EVENING.replace(day=day), number=3)[0] for day in (3, 1, 2)]
    new, deleted = keep(EVENING.replace(day=4), number=3)
    assert names(deleted) == [made[1].name]
    assert keeping.backups(folder, LATER) == [made[2], made[0], new]
    assert {"laserbot-old.db", "notes.txt"} <= set(everything(folder))


def test_the_new_one_stays_though_the_clock_went_back(keep, folder: Path) -> None:
    old, _ = keep()
    new, deleted = keep(EVENING.replace(year=1970), number=1)
    assert deleted == [old]
    assert keeping.backups(folder, LATER) == [new]


def test_what_a_killed_one_has_left_is_deleted(keep, folder: Path) -> None:
    (folder / "laserbot-2026-11-27T201500Z.db.part-17").write_text("half")
    made, _ = keep()
    assert everything(folder) == [".lock", made.name, "laserbot-old.db", "notes.txt"]


@pytest.mark.parametrize("fault", ["room", "cut", "database", "damaged", "volume", "two"])
def test_one_that_fails_says_why_and_deletes_nothing(
    fault: str, keep, url: URL, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    keep(EVENING.replace(day=1), number=1)
    there, into, database = everything(folder), folder, Path(url.database or "")
    with (folder / ".lock").open() as lock:
        match fault:
            case "room":
                monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=0))
                words = r"there is no room in .*backups: the backup needs 0\.\d MB, and 0\.0 MB are free"
            case "cut":
                monkeypatch.setattr(sqlite3, "connect", full(sqlite3.connect))
                words = "database or disk is full"
            case "database":
                database.unlink()
                words = "there is no database .*laserbot.db"
            case "damaged":
                database.write_bytes(b"what is this? " * 1000)
                words = "not a database"
            case "volume":
                into = folder / "nowhere"
                words = "there is no folder .*nowhere: is its volume there?"
            case "two":
                fcntl.flock(lock, fcntl.LOCK_EX)
                words = "another backup is being written in .*backups"
        with pytest.raises(CopyError, match=words):
            keep(number=1, into=into)
    assert everything(folder) == there


def full(connect: Callable[..., sqlite3.Connection]) -> Callable[..., sqlite3.Connection]:
    """A disk on which a new file cannot grow."""

    def limited(file: object, **options: object) -> sqlite3.Connection:
        connection = connect(file, **options)
        if ".part-" in str(file):
            connection.execute("PRAGMA max_page_count=2")
        return connection

    return limited


@pytest.mark.parametrize(
    ("made", "number", "stay"),
    [
        ("01T04 02T04 03T04 04T04", 3, "02T04 03T04 04T04"),
        ("01T04 02T04 02T20 03T04 03T20", 3, "01T04 02T20 03T04 03T20"),
        ("01T04 02T04 02T05 02T06 02T07", 3, "01T04 02T05 02T06 02T07"),
        ("01T04 02T04 02T20", 1, "02T20"),
        ("30T04 01T04 02T04 03T04", 3, "01T04 02T04 03T04"),
        ("30T04 03T04", 3, "30T04 03T04"),
    ],
    ids=["nightly", "before updates, too", "a bad day", "only one", "of a clock that was ahead", "which may stay"],
)
def test_what_stays(made: str, number: int, stay: str, folder: Path) -> None:
    paths = {moment: folder / f"laserbot-2026-11-{moment}0000Z.db" for moment in made.split()}
    for path in paths.values():
        path.touch()
    there = keeping.backups(folder, EVENING.replace(day=4))
    assert there == list(paths.values())
    deleted = keeping.superfluous(there, number)
    assert [path for path in there if path not in deleted] == [paths[moment] for moment in stay.split()]


def test_the_newest_of_a_folder_is_not_one_of_the_future(keep, url: URL, folder: Path) -> None:
    for day in (27, 28, 30):
        keep(EVENING.replace(day=day))
    now = EVENING - timedelta(minutes=5)  # another node's clock
    assert keeping.newest(folder, now).name == "laserbot-2026-11-28T201500Z.db"
    assert keeping.newest(folder, EVENING.replace(year=1970)).name == "laserbot-2026-11-30T201500Z.db"


def test_the_newest_of_a_folder_is_put_back(keep, url: URL, folder: Path, tmp_path: Path) -> None:
    database = Path(url.database or "")
    for day in (2, 1):
        with closing(sqlite3.connect(database)) as connection:
            connection.execute(f"PRAGMA user_version={day}")
        keep(EVENING.replace(year=1999, day=day))
    done = store("restore", str(folder), LASERBOT_DATA=str(database.parent))
    assert f"as in {folder}/laserbot-1999-11-02T201500Z.db; what was there is kept as {database}.before" in done.stderr
    with closing(sqlite3.connect(database)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (2,)
    assert "there is no backup in" in store("restore", str(tmp_path), LASERBOT_DATA=str(database.parent)).stderr


def store(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "server.store", *words],
        cwd=environment["LASERBOT_DATA"],
        env={"PATH": os.environ["PATH"], **ENVIRONMENT, **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


AT = time(4)


@pytest.mark.parametrize(
    ("made", "now", "due"),
    [
        ([], EVENING, True),
        ([EVENING.replace(hour=4, minute=0)], EVENING, False),
        ([EVENING.replace(hour=3, minute=59)], EVENING, True),
        ([EVENING.replace(day=27, hour=5)], EVENING.replace(hour=3), False),
        ([EVENING.replace(day=26)], EVENING.replace(hour=3), True),
        ([EVENING.replace(year=2027)], EVENING, True),
        ([EVENING, EVENING.replace(year=2027)], EVENING, False),
    ],
    ids=["the first", "today's", "before its time", "yesterday's", "missed", "from the future", "besides"],
)
def test_a_daily_one_is_due_once_its_time_has_come(
    made: list[datetime], now: datetime, due: bool, folder: Path, keep
) -> None:
    for moment in made:
        keep(moment)
    assert keeping.is_due(folder, AT, now) is due


def test_the_daily_program_makes_up_for_what_it_has_missed_and_ends(keep, url: URL, folder: Path) -> None:
    old, _ = keep(EVENING.replace(year=1999))
    environment = {**ENVIRONMENT, "LASERBOT_DATA": str(Path(url.database or "").parent), "LASERBOT_BACKUPS": "1"}
    alive = folder / "alive"
    program = Program.python(
        "server.store", "keep", str(folder), "--daily", "04:00", env=environment | {"LASERBOT_ALIVE_FILE": str(alive)}
    )
    try:
        program.wait_for(f"deleted: {old.name}")
        until(alive.exists, 10, "a sign of life")
        (made,) = keeping.backups(folder, LATER)
        program.process.send_signal(signal.SIGTERM)
        assert program.exit_code() == 0
    finally:
        program.stop()
    assert keeping.backups(folder, LATER) == [made]


@pytest.mark.parametrize(
    ("words", "environment", "said"),
    [
        (["keep", ".", "--daily", "25:00"], {}, "25:00 is no time of day such as 04:00"),
        (["keep", "."], {"LASERBOT_BACKUPS": "0"}, "LASERBOT_BACKUPS=0: must be a whole number from 1 to 1000"),
        (["keep"], {}, "FOLDER"),
    ],
)
def test_a_wrong_word_is_named(words: list[str], environment: dict[str, str], said: str, tmp_path: Path) -> None:
    done = store(*words, **{"LASERBOT_DATA": str(tmp_path), **environment})
    assert done.returncode == 2
    assert said in done.stderr
    assert list(tmp_path.iterdir()) == []
