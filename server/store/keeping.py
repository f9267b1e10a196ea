"""A folder of backups: those of the newest days stay, and each is whole."""

import fcntl
import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, date, datetime, timedelta
from datetime import time as time_of_day
from pathlib import Path

from sqlalchemy import URL

from server.store import backup, transfer
from server.store.backup import CopyError

_FORM = "laserbot-%Y-%m-%dT%H%M%SZ.db"
_NAME = re.compile(r"laserbot-\d{4}-\d\d-\d\dT\d{6}Z\.db")
_LOCK = ".lock"
_AHEAD = timedelta(minutes=10)  # that clocks of a cluster's nodes may differ
_MARGIN = 2**20  # bytes, for what a file system keeps about a file


def save(url: URL, target: Path, progress: Callable[[int], None]) -> int:
    """Write the database as it is at this moment into the file `target`; returns its size in bytes. CopyError,
    OSError."""
    file = backup.sqlite_file(url)
    return backup.back_up(file, target, progress) if file else transfer.back_up(url, target, progress)


def put_back(url: URL, source: Path, progress: Callable[[int], None]) -> str:
    """Put what the file `source` has in the place of the database; returns where that is kept, "" if there was none.
    CopyError, OSError."""
    file = backup.sqlite_file(url)
    if file:
        before = backup.restore(source, file)
        return str(before or "")
    schema = transfer.restore(source, url, progress)
    return f"its schema {schema}" if schema else ""


def keep(
    url: URL, folder: Path, number: int, now: datetime, progress: Callable[[int], None]
) -> tuple[Path, list[Path]]:
    """Save the database in the folder, and delete the backups there that are superfluous then; returns the new one, and
    those that were deleted. CopyError, OSError: then all are still there."""
    with _alone_in(folder):
        _check_room(folder, _size(url))
        made = folder / f"{now.astimezone(UTC):{_FORM}}"
        save(url, made, progress)
        # the new one stays, even if the clock has been set back
        others = [path for path in backups(folder, now) if path != made]
        deleted = superfluous([*others, made], number)
        for path in deleted:
            path.unlink()
    return made, deleted


def superfluous(paths: Sequence[Path], number: int) -> list[Path]:
    """Of these backups, the oldest first: all but the newest of each of the last `number` days, and the last day's
    other ones, of which as many stay. So those before updates take the place of no other day's, nor of each other."""
    days: dict[date, list[Path]] = {}
    for path in reversed(paths):
        days.setdefault(_made_at(path).date(), []).append(path)
    last, *earlier = days.values()
    stay = {*last[:number], *(of_day[0] for of_day in earlier[: number - 1])}
    return [path for path in paths if path not in stay]


def backups(folder: Path, now: datetime) -> list[Path]:
    """Oldest first. What a clock that was ahead has dated in the future is of an unknown time: it counts as older than
    all others."""
    there = [path for path in folder.iterdir() if _NAME.fullmatch(path.name)]
    return sorted(there, key=lambda path: (_made_at(path) <= now + _AHEAD, path))


def newest(folder: Path, now: datetime) -> Path:
    """CopyError if there is none."""
    there = backups(folder, now)
    if not there:
        raise CopyError(f"there is no backup in {folder}")
    return there[-1]


def is_due(folder: Path, at: time_of_day, now: datetime) -> bool:
    """Whether there is no backup since it was last that time of day, in the time zone of `now`. CopyError, OSError."""
    _check_folder(folder)
    made = map(_made_at, backups(folder, now))
    today = datetime.combine(now.date(), at, now.tzinfo)
    last = today if today <= now else today - timedelta(days=1)
    # the clock of a host without a battery may have been ahead
    return not any(last <= moment <= now for moment in made)


def _made_at(path: Path) -> datetime:
    return datetime.strptime(path.name, _FORM).replace(tzinfo=UTC)


def _size(url: URL) -> int:
    file = backup.sqlite_file(url)
    if file is None:
        return transfer.size(url)
    parts = [file, file.with_name(f"{file.name}-wal")]
    return sum(part.stat().st_size for part in parts if part.exists())


def _check_folder(folder: Path) -> None:
    if not folder.is_dir():
        raise CopyError(f"there is no folder {folder}: is its volume there?")


def _check_room(folder: Path, needed: int) -> None:
    free = shutil.disk_usage(folder).free
    if free < needed + _MARGIN:
        raise CopyError(
            f"there is no room in {folder}: the backup needs {needed / 1e6:.1f} MB, and {free / 1e6:.1f} MB are free"
        )


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """CopyError if another backup is being written there. What an earlier one has left unfinished is deleted."""
    _check_folder(folder)
    with (folder / _LOCK).open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CopyError(f"another backup is being written in {folder}") from None
        for left in folder.glob("laserbot-*.db.part-*"):
            left.unlink(missing_ok=True)
        yield
