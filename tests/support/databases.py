"""What the tests ask of a database behind the server's back, and do to it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy import URL, create_engine, select, text
from sqlalchemy.pool import NullPool

from server.game.events import Recorded, from_json
from server.store import schema


def rows(url: URL, table: str) -> list[Any]:
    """All of a table, in the order of its first column."""
    source = schema.metadata.tables[table]
    with create_engine(url, poolclass=NullPool).connect() as connection:
        return list(connection.execute(select(source).order_by(source.columns[0])))


def events(url: URL) -> list[Recorded]:
    """All that was decided, in order."""
    return [Recorded(at, from_json(kind, data)) for _, at, _, kind, data, _ in rows(url, "events")]


@contextmanager
def taken(url: URL) -> Iterator[None]:
    """Another program has it all for itself."""
    with create_engine(url, poolclass=NullPool).connect() as connection:
        is_file = url.get_backend_name() == "sqlite"
        connection.execute(text("BEGIN EXCLUSIVE" if is_file else "LOCK state, events, battles, robots"))
        yield
