"""`python3 -m server.store`: save the database, put it back, delete a player's data (docs/results.md)."""

import argparse
import sys
import unicodedata
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from os import environ
from pathlib import Path

from sqlalchemy import URL
from sqlalchemy.exc import SQLAlchemyError

from laser_bot_battle import variables
from laser_bot_battle.settings import describe, read_or_exit
from server.store import backup, forget, versions
from server.store.database import make_engine
from server.store.location import database_url

_PROGRAM = "server.store"


def main() -> int:
    """Exit code 0 when it is done, 1 when it cannot be, 2 for a wrong command line or setting."""
    commands: Mapping[str, Callable[[URL, str], str]] = {"backup": _back_up, "restore": _restore, "forget": _forget}
    given = _parser().parse_args()
    url = read_or_exit(_PROGRAM, database_url, environ)
    try:
        done = commands[given.command](url, given.what)
    except (backup.CopyError, forget.ForgetError, versions.NewerError, OSError) as error:
        return _fail(error)
    except SQLAlchemyError as error:
        return _fail(getattr(error, "orig", None) or error)
    _say(done)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        f"python3 -m {_PROGRAM}",
        description="The database of the game: save it, put it back, delete a player's data.",
        epilog=describe(variables.DATA, variables.DATABASE),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    for name, what, text in (
        ("backup", "FILE", "save all in FILE (- for standard output), while the server runs or not"),
        ("restore", "FILE", "put back what FILE (- for standard input) has; the web server must be stopped"),
        ("forget", "NAME", "replace a player's name everywhere, while the server runs or not"),
    ):
        commands.add_parser(name, help=text, description=text).add_argument("what", metavar=what)
    return parser


def _back_up(url: URL, file: str) -> str:
    database = backup.sqlite_file(url)
    with backup.sent(database) if file == "-" else nullcontext(Path(file)) as target:
        size = backup.back_up(database, target, _progress)
    return f"{size / 1e6:.1f} MB saved{'' if file == '-' else f' in {file}'}"


def _restore(url: URL, file: str) -> str:
    database = backup.sqlite_file(url)
    with backup.received(database) if file == "-" else nullcontext(Path(file)) as source:
        before = backup.restore(source, database)
    kept = f"; what was there is kept as {before}" if before else ""
    return f"{database} is as in {'the backup' if file == '-' else file}{kept}. The web server can be started."


def _forget(url: URL, name: str) -> str:
    is_file = url.get_backend_name() == "sqlite"
    if is_file and not backup.sqlite_file(url).exists():
        raise backup.CopyError(f"there is no database {url.database}")
    engine = make_engine(url)
    try:
        with engine.begin() as connection:
            versions.prepare(connection)
            neutral = forget.forget(connection, unicodedata.normalize("NFC", name))
    finally:
        engine.dispose()
    if is_file:
        backup.tidy(backup.sqlite_file(url))
    return f"{name} is {neutral} now. Backups and logs that were made before still have the name."


def _progress(percent: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{percent} %", end="\r" if percent == 100 else "", file=sys.stderr, flush=True)


def _say(text: str) -> None:
    print(text, file=sys.stderr)  # standard output may be the backup


def _fail(reason: object) -> int:
    print(f"{_PROGRAM}: {reason}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
