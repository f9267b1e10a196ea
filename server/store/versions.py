"""The steps that bring an older database to this program's version."""

from collections.abc import Callable

from sqlalchemy import Connection, insert, inspect, select, text
from sqlalchemy.schema import CreateColumn

from server.store import schema
from server.store.fighters import keep_fighters


def _add_fighters(connection: Connection) -> None:
    """Version 2: who fought has a table of its own, and a battle may not count."""
    counts = CreateColumn(schema.battles.c.counts).compile(dialect=connection.dialect)
    connection.execute(text(f"ALTER TABLE battles ADD COLUMN {counts}"))
    for index in schema.battles.indexes:
        index.create(connection)
    for battle in connection.scalars(select(schema.battles.c.id)).all():
        keep_fighters(connection, battle)


def _add_shooters(connection: Connection) -> None:
    """It is known who has shot; of older battles it is not. That is no version of its own: older programs do without
    these columns, so that an update can be taken back."""
    there = {column["name"] for column in inspect(connection).get_columns("fighters")}
    fighters = schema.fighters.c
    for column in (fighters.team, fighters.shots, fighters.given, fighters.kills):
        if column.name not in there:
            added = CreateColumn(column).compile(dialect=connection.dialect)
            connection.execute(text(f"ALTER TABLE fighters ADD COLUMN {added}"))


# what brings a database from the version of its place in the list (the first: 1) to the next one; tables that are not
# there yet have been made before
STEPS: tuple[Callable[[Connection], None], ...] = (_add_fighters,)
VERSION = len(STEPS) + 1


class NewerError(Exception):
    """The database was made by a newer version of this program."""


def prepare(connection: Connection) -> None:
    """Make the tables, or bring those of an older version to this one."""
    schema.metadata.create_all(connection)
    _add_shooters(connection)
    found = connection.scalar(select(schema.schema.c.version))
    if found is None:
        connection.execute(insert(schema.schema).values(version=VERSION))
    elif found > VERSION:
        raise NewerError(f"it is of version {found}, and this program knows {VERSION}: update the program")
    elif found < VERSION:
        for step in STEPS[found - 1 :]:
            step(connection)
        connection.execute(schema.schema.update().values(version=VERSION))
