"""A master's results outlast the partition that they are on: a copy of its newest backup lies on the card's first one.

    python3 -m cards.backups [--boot FOLDER] [--data FOLDER]

Run whenever the game has made a backup (laserbot-backups.path). A master without results takes them from there when it
starts (cards/start.py): after its state was made anew, or on another card to which somebody has copied the file.
"""

import argparse
import filecmp
import os
import re
import shutil
import sqlite3
import sys
from contextlib import closing
from pathlib import Path

from cards.files import CONTAINER_USER
from cards.telling import tell

COPY = "laserbot-results.db"
DATA = "var/lib/laserbot"  # of the game; in it, its database and the folder of its backups
_DATABASE, _BACKUPS = "laserbot.db", "backups"
_BACKUP = re.compile(r"laserbot-\d{4}-\d\d-\d\dT\d{6}Z\.db")  # server/store/keeping.py: one that is whole
_ROOM = 32 << 20  # bytes that stay free on the first partition


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    parser.add_argument("--data", type=Path, default=Path("/") / DATA, help="the game's data")
    arguments = parser.parse_args()
    return keep(arguments.boot, arguments.data)


def keep(boot: Path, data: Path) -> int:
    """Copy the newest backup; the program's exit code."""
    there = [path for path in (data / _BACKUPS).iterdir() if _BACKUP.fullmatch(path.name)]
    problem = _keep(max(there), boot / COPY) if there else ""
    tell(boot, COPY, problem)
    return 1 if problem else 0


def _keep(backup: Path, target: Path) -> str:
    """What has gone wrong."""
    if target.exists() and filecmp.cmp(backup, target, shallow=False):
        return ""
    needed, free = backup.stat().st_size + _ROOM, shutil.disk_usage(target.parent).free
    if free < needed:
        return f"the backup of the results needs {needed >> 20} MiB here, and {free >> 20} are free"
    try:
        _copy(backup, target)
    except OSError as error:
        return f"the backup of the results cannot be copied: {error.strerror}"
    return ""


def restore(boot: Path, data: Path) -> None:
    """Give a master without results those of the copy, if there is one."""
    copy, database = boot / COPY, data / _DATABASE
    if database.exists() or not copy.exists():
        return
    problem = ""
    try:
        _check(copy)
        _copy(copy, database, CONTAINER_USER)
    except (OSError, sqlite3.Error) as error:
        problem = f"the results cannot be taken from it: {error}"
    else:
        print(f"the results are those of {COPY}", file=sys.stderr)
    tell(boot, COPY, problem)


def _check(database: Path) -> None:
    """sqlite3.Error unless it is whole."""
    with closing(sqlite3.connect(f"{database.absolute().as_uri()}?mode=ro&immutable=1", uri=True)) as opened:
        found = opened.execute("PRAGMA quick_check(1)").fetchone()[0]
    if found != "ok":
        raise sqlite3.DatabaseError(found)


def _copy(source: Path, target: Path, owner: int | None = None) -> None:
    """Atomically: the power may go at any moment."""
    new = target.with_name(f"{target.name}.new")
    with source.open("rb") as read, new.open("wb") as written:
        shutil.copyfileobj(read, written)
        written.flush()
        os.fsync(written.fileno())
    if owner is not None:
        shutil.chown(new, owner, owner)
    new.replace(target)


if __name__ == "__main__":
    sys.exit(main())
