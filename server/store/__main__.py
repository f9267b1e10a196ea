"""`python3 -m server.store`: save the database, put it back, delete a player's data (docs/results.md)."""

import argparse
import logging
import signal
import sys
import threading
import time
import unicodedata
from argparse import Namespace
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from datetime import datetime
from datetime import time as time_of_day
from os import environ
from pathlib import Path

from sqlalchemy import URL
from sqlalchemy.exc import SQLAlchemyError

from laser_bot_battle import alive, variables
from laser_bot_battle.log import configure_logging
from laser_bot_battle.settings import describe, read_or_exit
from server.store import backup, forget, keeping, versions
from server.store.database import make_engine, reason_of
from server.store.location import data_folder, database_url

_log = logging.getLogger("server.store")

_PROGRAM = "server.store"
_RETRY = 600.0  # s until a daily backup that has failed is tried again


def main() -> int:
    """Exit code 0 when it is done, 1 when it cannot be, 2 for a wrong command line or setting."""
    commands: Mapping[str, Callable[[URL, Namespace], str]] = {
        "backup": _back_up,
        "keep": _keep,
        "restore": _restore,
        "forget": _forget,
    }
    given = _parser().parse_args()
    url = read_or_exit(_PROGRAM, database_url, environ)
    if given.command == "keep" and given.daily:
        return _keep_daily(url, given)
    try:
        done = commands[given.command](url, given)
    except _FAULTS as error:
        return _fail(error)
    _say(done)
    return 0


_FAULTS = (backup.CopyError, forget.ForgetError, versions.NewerError, OSError, SQLAlchemyError)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        f"python3 -m {_PROGRAM}",
        description="The database of the game, a file or PostgreSQL: save it, put it back, delete a player's data.",
        epilog=describe(
            variables.DATA, variables.DATABASE, variables.BACKUPS, variables.LOG_LEVEL, variables.LOG_FORMAT
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)

    def add(name: str, what: str, text: str) -> argparse.ArgumentParser:
        command = commands.add_parser(name, help=text, description=text)
        command.add_argument("what", metavar=what)
        return command

    add("backup", "FILE", "save all in FILE (- for standard output), while the server runs or not")
    keep = add("keep", "FOLDER", "save all in FOLDER, as laserbot-DATE.db, and delete what is superfluous there")
    keep.add_argument("--daily", metavar="HH:MM", type=_time_of_day, help="each day at that time, until it is ended")
    add(
        "restore",
        "FILE",
        "put back what FILE (- for standard input; of a folder, the newest) has, while no server runs",
    )
    add("forget", "NAME", "replace a player's name everywhere, while the server runs or not")
    return parser


def _time_of_day(text: str) -> time_of_day:
    try:
        return datetime.strptime(text, "%H:%M").time()
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} is no time of day such as 04:00") from None


def _back_up(url: URL, given: Namespace) -> str:
    file = given.what
    with backup.sent(_room(url)) if file == "-" else nullcontext(Path(file)) as target:
        size = keeping.save(url, target, _progress)
    return f"{size / 1e6:.1f} MB saved{'' if file == '-' else f' in {file}'}"


def _keep(url: URL, given: Namespace) -> str:
    number = read_or_exit(_PROGRAM, variables.BACKUPS.read, environ)
    made, superfluous = keeping.keep(url, Path(given.what), number, datetime.now().astimezone(), _progress)
    deleted = f"; deleted: {', '.join(path.name for path in superfluous)}" if superfluous else ""
    return f"{made.stat().st_size / 1e6:.1f} MB saved in {made}{deleted}"


def _keep_daily(url: URL, given: Namespace) -> int:
    """Until a signal ends it. What was missed while it did not run is made up for at its start."""
    read_or_exit(_PROGRAM, variables.BACKUPS.read, environ)
    configure_logging(read_or_exit(_PROGRAM, variables.LOG_LEVEL.read, environ))
    ending = threading.Event()
    for end in (signal.SIGINT, signal.SIGTERM):
        signal.signal(end, lambda *_: ending.set())
    not_before = 0.0
    while not ending.is_set():
        alive.touch()
        try:
            if time.monotonic() >= not_before and keeping.is_due(
                Path(given.what), given.daily, datetime.now().astimezone()
            ):
                _log.info("%s", _keep(url, given))
        except _FAULTS as error:
            _log.error("%s; tried again in %.0f min", _reason(error), _RETRY / 60)
            not_before = time.monotonic() + _RETRY
        ending.wait(alive.PERIOD)
    return 0


def _restore(url: URL, given: Namespace) -> str:
    file = given.what
    with backup.received(_room(url)) if file == "-" else nullcontext(Path(file)) as given_file:
        is_folder = given_file.is_dir()
        source = keeping.newest(given_file, datetime.now().astimezone()) if is_folder else given_file
        before = keeping.put_back(url, source, _progress)
    kept = f"; what was there is kept as {before}" if before else ""
    from_where = "the backup" if file == "-" else source
    return f"{url.database} is as in {from_where}{kept}. The web server can be started."


def _room(url: URL) -> Path:
    """The folder where a file of the database's size has room."""
    file = backup.sqlite_file(url)
    return file.parent if file else data_folder(environ)


def _forget(url: URL, given: Namespace) -> str:
    name, file = given.what, backup.sqlite_file(url)
    if file and not file.exists():
        raise backup.CopyError(f"there is no database {file}")
    engine = make_engine(url)
    try:
        with engine.begin() as connection:
            versions.prepare(connection)
            neutral = forget.forget(connection, unicodedata.normalize("NFC", name))
    finally:
        engine.dispose()
    if file:
        backup.tidy(file)
    return f"{name} is {neutral} now. Backups and logs that were made before still have the name."


def _progress(percent: int) -> None:
    alive.touch()
    if sys.stderr.isatty():
        print(f"\r{percent} %", end="\r" if percent == 100 else "", file=sys.stderr, flush=True)


def _say(text: str) -> None:
    print(text, file=sys.stderr)  # standard output may be the backup


def _fail(error: BaseException) -> int:
    print(f"{_PROGRAM}: {_reason(error)}", file=sys.stderr)
    return 1


def _reason(error: BaseException) -> str:
    match error:
        case SQLAlchemyError():
            return reason_of(error)
        case OSError(strerror=str(why), filename=str(where)):
            return f"{where}: {why}"
    return str(error)


if __name__ == "__main__":
    sys.exit(main())
