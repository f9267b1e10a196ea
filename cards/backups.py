"""A master's results outlast the partition that they are on: a copy of them lies on the card's first one.

    python3 -m cards.backups [--boot FOLDER] [--root FOLDER]

Run every ten minutes (laserbot-backups.timer). A master without results takes them from there when it starts
(cards/start.py): after its state was made anew, or on another card to which somebody has copied the file.
"""

import argparse
import filecmp
import os
import shutil
import sqlite3
import sys
from contextlib import closing
from pathlib import Path

from cards.files import CONTAINER_USER, STATE
from cards.telling import tell

COPY, DAMAGED = "laserbot-results.db", "laserbot-results-damaged.db"
DATA = "var/lib/laserbot"  # of the game
_DATABASE = "laserbot.db"
_ROOM = 150 << 20  # bytes of the first partition that stay free: for an update


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    parser.add_argument("--root", type=Path, default=Path("/"), help="the system")
    arguments = parser.parse_args()
    return keep(arguments.boot, arguments.root)


def keep(boot: Path, root: Path) -> int:
    """Copy the results as they are now, unless they are as in the copy; the program's exit code."""
    database = root / DATA / _DATABASE
    if not database.exists():
        return 0
    problem, saved = "", root / STATE.relative_to("/") / COPY
    try:
        saved.parent.mkdir(parents=True, exist_ok=True)
        saved.unlink(missing_ok=True)
        _save(database, saved)
        _keep(saved, boot / COPY)
    except (OSError, sqlite3.Error) as error:
        problem = f"the results cannot be copied here: {error}"
    finally:
        saved.unlink(missing_ok=True)
    tell(boot, COPY, problem)
    return 1 if problem else 0


def _save(database: Path, target: Path) -> None:
    """As they are at this moment; the game may write on. sqlite3.Error unless they are whole."""
    with closing(_opened(database, "mode=ro")) as source, closing(sqlite3.connect(target)) as copy:
        source.backup(copy)
        copy.execute("PRAGMA journal_mode=DELETE")  # in one file
    _check(target)


def _keep(saved: Path, target: Path) -> None:
    new = _new(target)
    new.unlink(missing_ok=True)  # a cut has left it
    if target.exists() and filecmp.cmp(saved, target, shallow=False):
        return
    needed, free = saved.stat().st_size + _ROOM, shutil.disk_usage(target.parent).free
    if free < needed:
        raise OSError(f"{needed >> 20} MiB have to be free, and {free >> 20} are")
    _copy(saved, target)


def restore(boot: Path, root: Path) -> None:
    """Give a master without results those of the copy, if there is one. One that cannot be used gets another name: the
    game begins anew, and what it has then is copied, too."""
    copy, database = boot / COPY, root / DATA / _DATABASE
    if database.exists() or not copy.exists():
        return
    try:
        _check(copy)
        _copy(copy, database, CONTAINER_USER)
    except (OSError, sqlite3.Error) as error:
        tell(boot, DAMAGED, f"the results cannot be taken from it: {error}")
        copy.replace(boot / DAMAGED)
        return
    print(f"the results are those of {COPY}", file=sys.stderr)


def _check(database: Path) -> None:
    """sqlite3.Error unless it is whole, and holds anything."""
    with closing(_opened(database, "mode=ro&immutable=1")) as opened:
        found = opened.execute("PRAGMA quick_check(1)").fetchone()[0]
        if found != "ok":
            raise sqlite3.DatabaseError(found)
        if not opened.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            raise sqlite3.DatabaseError("there is nothing in it")


def _opened(database: Path, how: str) -> sqlite3.Connection:
    return sqlite3.connect(f"{database.absolute().as_uri()}?{how}", uri=True)


def _copy(source: Path, target: Path, owner: int | None = None) -> None:
    """Atomically: the power may go at any moment."""
    new = _new(target)
    new.unlink(missing_ok=True)
    with source.open("rb") as read, new.open("xb") as written:
        shutil.copyfileobj(read, written)
        written.flush()
        os.fsync(written.fileno())
    if owner is not None:
        shutil.chown(new, owner, owner)
    new.replace(target)
    os.sync()  # a FAT frees the old content before the new name is on the disk


def _new(target: Path) -> Path:
    return target.with_name(f"{target.name}.new")


if __name__ == "__main__":
    sys.exit(main())
