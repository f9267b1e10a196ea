"""The database as one file: saved while the server runs, put back while it does not. The file is always one of SQLite;
how a database on a server gets into it, and back, says `transfer`."""

import os
import shutil
import sqlite3
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from sqlalchemy import URL

from server.store import versions

_PAGES = 256  # copied at a time, 1 MB
_BUSY = 5.0  # s to wait for another writer


class CopyError(Exception):
    """It cannot be done; the text says why, and what to do."""


def sqlite_file(url: URL) -> Path | None:
    """None when the database is on a server. CopyError when it is nowhere."""
    if url.get_backend_name() != "sqlite":
        return None
    if not url.database:
        raise CopyError(f"{url} names no file")
    return Path(url.database)


def back_up(database: Path, target: Path, progress: Callable[[int], None]) -> int:
    """Copy the database as it is at this moment, the server may write on; returns the copy's size in bytes.

    `target` is there when all is in it, or as it was. `progress` gets percents. CopyError, OSError.
    """
    if not database.exists():
        raise CopyError(f"there is no database {database}")
    if target.exists() and target.samefile(database):
        raise CopyError(f"{target} is the database itself")
    with part_of(target) as part, _explained(database):
        with closing(_open(database, "ro")) as source, closing(sqlite3.connect(part)) as copy:
            source.execute("BEGIN")
            source.execute("SELECT * FROM sqlite_master").fetchone()  # from now on it sees this moment only
            source.backup(
                copy, pages=_PAGES, progress=lambda _, left, total: progress(100 - 100 * left // max(total, 1))
            )
        make_plain(part)
        check(part)
        settle(part, target)
    return target.stat().st_size


def restore(source: Path, database: Path) -> Path | None:
    """Put the database in `source` in the place of `database`; returns where that is kept. CopyError, OSError."""
    if not source.exists():
        raise CopyError(f"there is no file {source}")
    database.parent.mkdir(parents=True, exist_ok=True)
    with part_of(database) as part:
        with _explained(source), closing(_open(source, "ro")) as given, closing(sqlite3.connect(part)) as copy:
            given.backup(copy)
        check(part)
        with _alone(database):
            before = _unused(f"{database}.before") if database.exists() else None
            if before:
                database.replace(before)
            for suffix in ("-wal", "-shm"):
                database.with_name(database.name + suffix).unlink(missing_ok=True)
            settle(part, database)
    return before


def _unused(path: str) -> Path:
    """`path`, or with the next number behind it: what an earlier restore has put aside is perhaps the better one."""
    return next(file for number in ("", *range(2, 1000)) if not (file := Path(f"{path}{number}")).exists())


def bring_back(held: sqlite3.Connection, database: Path) -> None:
    """Put a database that was deleted back in its place, with all that is in it: `held` still has it open. CopyError,
    OSError."""
    database.parent.mkdir(parents=True, exist_ok=True)
    with part_of(database) as part:
        with _explained(database), closing(sqlite3.connect(part)) as copy:
            held.backup(copy)
        check(part)
        if database.exists():
            raise CopyError(f"there is another {database} meanwhile")
        for suffix in ("-wal", "-shm"):  # `held` has them open, and a new file must not share them
            database.with_name(database.name + suffix).unlink(missing_ok=True)
        part.replace(database)


def tidy(database: Path) -> None:
    """Write the file anew, so that nothing of what was deleted is left in its unused parts. CopyError."""
    with _explained(database), closing(_open(database, "rw")) as connection:
        connection.execute("VACUUM")
        busy, _, _ = connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
        if busy:
            raise CopyError(f"{database} is in use just now: run this again")


def _open(file: Path, mode: str) -> sqlite3.Connection:
    return sqlite3.connect(f"{file.absolute().as_uri()}?mode={mode}", uri=True, timeout=_BUSY, isolation_level=None)


def make_plain(file: Path) -> None:
    """One file without a log beside it, so that it can also be read where nothing can be written."""
    with _explained(file), closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA journal_mode=DELETE")


def settle(part: Path, target: Path) -> None:
    """Give the finished file its name once it is on the disk: a power cut leaves the old one or the new one."""
    with part.open("rb") as file:
        os.fsync(file.fileno())
    part.replace(target)
    folder = os.open(target.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def check(file: Path) -> None:
    """CopyError if the file is not a sound database of this system."""
    with _explained(file), closing(sqlite3.connect(file)) as connection:
        (found,) = connection.execute("PRAGMA quick_check(1)").fetchone()
        if found != "ok":
            raise CopyError(f"it is damaged: {found}")
        tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not {"schema", "battles", "events", "state"} <= tables:
            raise CopyError("it is a database, but not one of LaserBot Battle")
        (version,) = connection.execute("SELECT version FROM schema").fetchone()
        if version > versions.VERSION:
            raise CopyError(
                f"it is of version {version}, and this program knows {versions.VERSION}: update the program"
            )


@contextmanager
def _alone(database: Path) -> Iterator[None]:
    """Nobody else has the database open. CopyError if somebody has."""
    if not database.exists():
        yield
        return
    with closing(sqlite3.connect(database, timeout=0, isolation_level=None)) as connection:
        try:
            connection.execute("PRAGMA journal_mode=DELETE")  # only the sole user may change it
            connection.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            raise CopyError(f"{database} is in use ({error}): stop the web server first") from None
        except sqlite3.DatabaseError:
            pass  # it is broken: that may be why it is to be replaced
        yield


@contextmanager
def part_of(target: Path) -> Iterator[Path]:
    """A new file beside the target, which is gone afterwards if it has not taken its place."""
    part = target.with_name(f"{target.name}.part-{os.getpid()}")
    try:
        yield part
    finally:
        for suffix in ("", "-wal", "-shm", "-journal"):
            part.with_name(part.name + suffix).unlink(missing_ok=True)


@contextmanager
def _explained(file: Path) -> Iterator[None]:
    try:
        yield
    except sqlite3.Error as error:
        raise CopyError(f"{file}: {error}") from None


@contextmanager
def received(folder: Path) -> Iterator[Path]:
    """The bytes of standard input as a file in the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with part_of(folder / "received") as part:
        with part.open("wb") as file:
            shutil.copyfileobj(sys.stdin.buffer, file)
        yield part


@contextmanager
def sent(folder: Path) -> Iterator[Path]:
    """A file in the folder, whose bytes then go to standard output."""
    folder.mkdir(parents=True, exist_ok=True)
    with part_of(folder / "sent") as part:
        yield part
        with part.open("rb") as file:
            shutil.copyfileobj(file, sys.stdout.buffer)
