"""All tables from one database into another: of a PostgreSQL server into a file, as `backup` makes it, and back.

The rows go through the project's own tables, so neither the server's version nor its tools matter.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import (
    JSON,
    URL,
    Connection,
    Engine,
    MetaData,
    Table,
    create_engine,
    func,
    insert,
    inspect,
    select,
    text,
)
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.pool import NullPool

from server.store import schema, versions
from server.store.backup import CopyError, check, make_plain, part_of, settle
from server.store.database import make_engine, reason_of

BEFORE = "laserbot_before"  # PostgreSQL's schema in which a restore leaves what was there
_ROWS = 500  # at a time
_TIMEOUT = 30.0  # s for an answer of the server: nobody waits for this program


def back_up(url: URL, target: Path, progress: Callable[[int], None]) -> int:
    """Write all that the server has at this moment into the SQLite file `target`; returns its size in bytes.

    `target` is there when all is in it, or as it was. CopyError, OSError.
    """
    with part_of(target) as part:
        file = make_engine(URL.create("sqlite", database=str(part)))
        with _begun(make_engine(url, _TIMEOUT)) as source, _begun(file) as copy:
            source.execute(text("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ, READ ONLY"))
            _check_version(source)
            schema.metadata.create_all(copy)
            _copy(source, copy, progress)
        make_plain(part)
        check(part)
        settle(part, target)
    return target.stat().st_size


def restore(source: Path, url: URL, progress: Callable[[int], None]) -> str | None:
    """Put what the file has in the place of what the server has; returns PostgreSQL's schema where that is kept.
    CopyError, and then nothing has changed."""
    if not source.exists():
        raise CopyError(f"there is no file {source}")
    check(source)
    with _begun(_only_read(source)) as given, _begun(make_engine(url, _TIMEOUT)) as target:
        _check_version(given)
        _be_alone(target)
        before = _put_aside(target)
        schema.metadata.create_all(target)
        _copy(given, target, progress)
        for table in schema.metadata.sorted_tables:
            if "id" in table.c:
                sequence = func.pg_get_serial_sequence(table.name, "id")
                target.execute(select(func.setval(sequence, func.coalesce(func.max(table.c.id) + 1, 1), False)))
    return before


def size(url: URL) -> int:
    """Bytes that the server needs for it. CopyError."""
    with _begun(make_engine(url, _TIMEOUT)) as connection:
        return int(connection.scalar(text("SELECT pg_database_size(current_database())")) or 0)


def _copy(source: Connection, target: Connection, progress: Callable[[int], None]) -> None:
    known = inspect(source).get_table_names()  # an older program's has less
    tables = [table for table in schema.metadata.sorted_tables if table.name in known]
    rows = {table: _count(source, table) for table in tables}
    done, total = 0, max(sum(rows.values()), 1)
    for table in tables:
        there = {column["name"] for column in inspect(source).get_columns(table.name)}
        columns = [column for column in table.c if column.name in there]  # likewise
        into = _plain(table)
        for some in source.execute(select(*columns).execution_options(yield_per=_ROWS)).mappings().partitions():
            target.execute(insert(into).values([dict(row) for row in some]))
            done += len(some)
            progress(100 * done // total)
        if _count(target, table) != rows[table]:
            raise CopyError(f"{table.name}: {rows[table]} rows were read, and {_count(target, table)} are in the copy")


def _count(connection: Connection, table: Table) -> int:
    return connection.scalar(select(func.count()).select_from(table)) or 0


def _plain(table: Table) -> Table:
    """The table for rows as they are: what is missing stays missing, in JSON too."""
    plain = table.to_metadata(MetaData())
    for column in plain.c:
        if isinstance(column.type, JSON):
            column.type = JSON(none_as_null=True)
    return plain


def _check_version(connection: Connection) -> None:
    """CopyError if there is no database of this version."""
    if not {"schema", "battles", "events", "state"} <= set(inspect(connection).get_table_names()):
        raise CopyError("there is no database of LaserBot Battle there: the web server makes it when it starts")
    found = connection.scalar(select(schema.schema.c.version))
    if found != versions.VERSION:
        raise CopyError(
            f"it is of version {found}, and this program is for {versions.VERSION}: use the one of its version"
        )


def _be_alone(connection: Connection) -> None:
    """Nobody else is connected to it. CopyError if somebody is."""
    others = connection.scalars(
        text(
            "SELECT coalesce(host(client_addr), 'this machine') FROM pg_stat_activity "
            "WHERE datname = current_database() AND pid <> pg_backend_pid() AND usename IS NOT NULL"
        )
    ).all()
    if others:
        raise CopyError(f"it is in use from {', '.join(sorted(set(others)))}: stop the web servers of all arenas first")


def _put_aside(connection: Connection) -> str | None:
    """Move the tables that are there into a schema of their own, beside those of earlier times."""
    there = set(inspect(connection).get_table_names())
    names = [table.name for table in schema.metadata.sorted_tables if table.name in there]
    if not names:
        return None
    taken = inspect(connection).get_schema_names()
    before = next(name for number in ("", *range(2, 1000)) if (name := f"{BEFORE}{number}") not in taken)
    connection.execute(text(f"CREATE SCHEMA {before}"))
    for name in names:
        connection.execute(text(f'ALTER TABLE "{name}" SET SCHEMA {before}'))
    return before


def _only_read(file: Path) -> Engine:
    address = URL.create("sqlite", database=file.absolute().as_uri(), query={"mode": "ro", "uri": "true"})
    return create_engine(address, poolclass=NullPool)


@contextmanager
def _begun(engine: Engine) -> Iterator[Connection]:
    """A transaction, which is all or nothing. CopyError, with the database's address, for what is wrong there."""
    try:
        with engine.begin() as connection:
            yield connection
    except SQLAlchemyError as error:
        raise CopyError(f"{engine.url}: {reason_of(error)}") from None
    finally:
        engine.dispose()
