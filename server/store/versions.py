"""The steps that bring an older database to this program's version."""

from collections.abc import Callable

from sqlalchemy import Connection, Table, func, insert, inspect, select, text
from sqlalchemy.schema import CreateColumn, CreateIndex

from server.store import schema
from server.store.fighters import Outcome, keep_fighters


def _add_fighters(connection: Connection) -> None:
    """Version 2: who fought has a table of its own, and a battle may not count."""
    counts = CreateColumn(schema.battles.c.counts).compile(dialect=connection.dialect)
    connection.execute(text(f"ALTER TABLE battles ADD COLUMN {counts}"))
    for index in schema.battles.indexes:
        index.create(connection, checkfirst=True)
    battles = schema.battles.c
    for battle, *outcome in connection.execute(select(battles.id, battles.began, battles.ended, battles.result)).all():
        keep_fighters(connection, battle, Outcome(*outcome))


def _add_columns(connection: Connection) -> None:
    """It is known who has shot, and which arena it was; of what is older it is not. That is no version of its own:
    older programs do without these columns, so that an update can be taken back."""
    shooters = ("team", "shots", "given", "kills")
    arena = _add(connection, schema.events, "arena")
    for table, names in (
        (schema.fighters, shooters),
        (schema.battles, ("arena", "tallied")),
        (schema.state, ("arena",)),
        (schema.robots, ("arena",)),
        (schema.forgotten, ("arenas",)),
    ):
        _add(connection, table, *names)
    for index in schema.battles.indexes:
        index.create(connection, checkfirst=True)
    for index in schema.standings.indexes:  # of an expression, which SQLAlchemy does not find in a file
        connection.execute(CreateIndex(index, if_not_exists=True))
    if arena:
        for index in (*schema.events.indexes, *schema.state.indexes):
            index.create(connection, checkfirst=True)
        if connection.dialect.name == "postgresql":  # a file is of one arena
            connection.execute(
                text(
                    "ALTER TABLE robots DROP CONSTRAINT robots_pkey, DROP CONSTRAINT robots_robot_key, "
                    "ADD PRIMARY KEY (caller, arena), ADD UNIQUE (robot, arena)"
                )
            )


def _add(connection: Connection, table: Table, *names: str) -> bool:
    """Add the columns of these names that are not there; returns whether there was one."""
    there = {column["name"] for column in inspect(connection).get_columns(table.name)}
    missing = [name for name in names if name not in there]
    for name in missing:
        added = CreateColumn(table.c[name]).compile(dialect=connection.dialect)
        connection.execute(text(f"ALTER TABLE {table.name} ADD COLUMN {added}"))
    return bool(missing)


# what brings a database from the version of its place in the list (the first: 1) to the next one; tables that are not
# there yet have been made before
STEPS: tuple[Callable[[Connection], None], ...] = (_add_fighters,)
VERSION = len(STEPS) + 1

_MAKING = 0x1A5E_2B07  # advisory locks are known by a number; this one is ours


class NewerError(Exception):
    """The database was made by a newer version of this program."""


def prepare(connection: Connection) -> None:
    """Make the tables, or bring those of an older version to this one."""
    if connection.dialect.name == "postgresql" and not inspect(connection).has_table(schema.schema.name):
        # of arenas that find a new database at the same time, one makes the tables and the others wait for it
        connection.execute(select(func.pg_advisory_xact_lock(_MAKING)))
    schema.metadata.create_all(connection)
    _add_columns(connection)
    found = connection.scalar(select(schema.schema.c.version))
    if found is None:
        connection.execute(insert(schema.schema).values(version=VERSION))
    elif found > VERSION:
        raise NewerError(f"it is of version {found}, and this program knows {VERSION}: update the program")
    elif found < VERSION:
        for step in STEPS[found - 1 :]:
            step(connection)
        connection.execute(schema.schema.update().values(version=VERSION))
