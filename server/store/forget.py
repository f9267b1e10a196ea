"""Deleting a player's data: battles stay, and another name stands where the player's was.

Works beside servers that run. Each may still show the player in its last result, and would write the name again:
until it has a new result, it is told by the table `forgotten` what to write instead.
"""

import hashlib
import time
from collections.abc import Callable, Mapping
from typing import Any

from sqlalchemy import Connection, RowMapping, Table, insert, select, update

from server.game.events import KINDS, BattleEnded
from server.game.people import Rename, rename_each, rename_fields, renamers
from server.game.state import State
from server.game.users import User, is_valid_name
from server.store import schema

_IN_EVENTS = {name: renamers(kind) for name, kind in KINDS.items()}
# of a kind that only another version knows: fields of the same names mean the same
_IN_ANY_EVENT = {field: renamer for fields in _IN_EVENTS.values() for field, renamer in fields.items()}
_IN_STATE = renamers(State)
_IN_USER = renamers(User)


class ForgetError(Exception):
    """It cannot be done now; the text says what to do."""


def forget(connection: Connection, name: str) -> str:
    """Replace the name everywhere; returns what stands there now. ForgetError."""
    nobody = ForgetError(f"there is nobody called {name!r} in the database; capitals matter")
    if not is_valid_name(name):
        raise nobody
    # written first, so that nobody else writes from here on
    arenas = list(connection.scalars(select(schema.state.c.arena)))
    given = {"at": time.time(), "digest": _digest(name) if arenas else None, "arenas": arenas}
    made = connection.execute(insert(schema.forgotten).values(given))
    number = made.inserted_primary_key[0] if made.inserted_primary_key else 0
    neutral = _neutral(number)
    for state in connection.scalars(select(schema.state.c.data)):
        if name in _names(state, "users", "queue"):
            raise ForgetError(f"{name} is signed in: sign out first")
        if name in state.get("banned", ()):
            raise ForgetError(f"{name} is banned, which needs the name: allow it again first")
    changed = sum(_rename(connection, table, change, {name: neutral}) for table, change in _NAMED.items())
    if not changed:
        raise nobody
    return neutral


def find_forgotten(connection: Connection, saved: Mapping[str, Any], arena: str) -> dict[str, str]:
    """What is to be written instead of names that the game in `saved`, the arena's, still remembers, though they were
    deleted."""
    pending = connection.execute(select(schema.forgotten).where(schema.forgotten.c.digest.is_not(None))).all()
    rows = [row for row in pending if arena in (row.arenas or [""])]
    by_digest = {_digest(name): name for name in _remembered(saved)} if rows else {}
    found = {by_digest[row.digest]: _neutral(row.id) for row in rows if row.digest in by_digest}
    for row in rows:
        if row.digest not in by_digest:
            arenas = [other for other in row.arenas or () if other != arena]
            values = {"arenas": arenas, "digest": row.digest if arenas else None}
            connection.execute(update(schema.forgotten).where(schema.forgotten.c.id == row.id).values(values))
    return found


def rename_in_event(kind: str, fields: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """The event's fields with these names replaced where they name people."""
    return rename_fields(fields, _by(names), _IN_EVENTS.get(kind, _IN_ANY_EVENT))


def rename_in_state(saved: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """The saved state likewise. A ban is of a name, whoever has it, and stays."""
    return _rename_in_state(saved, _by(names))


def _rename_in_state(saved: Mapping[str, Any], rename: Rename) -> dict[str, Any]:
    renamed = rename_fields(saved, rename, _IN_STATE)
    if "users" in saved:  # a class of its own in the state, in JSON a list like the others
        renamed["users"] = rename_each(saved["users"], rename, _IN_USER)
    return renamed


def _by(names: Mapping[str, str]) -> Rename:
    return lambda name: names.get(name, name)


def _in_battle(row: RowMapping, names: Mapping[str, str]) -> dict[str, Any]:
    return rename_in_event(BattleEnded.__name__, {"cause": row["cause"], "result": row["result"]}, names)


# what replaces the names in a row of each table that has some
_NAMED: Mapping[Table, Callable[[RowMapping, Mapping[str, str]], dict[str, Any]]] = {
    schema.fighters: lambda row, names: {"name": names.get(row["name"], row["name"])},
    schema.standings: lambda row, names: {"name": names.get(row["name"], row["name"])},
    schema.events: lambda row, names: {"data": rename_in_event(row["kind"], row["data"], names)},
    schema.battles: _in_battle,
    schema.state: lambda row, names: {"data": rename_in_state(row["data"], names)},
}


def _rename(
    connection: Connection,
    table: Table,
    change: Callable[[RowMapping, Mapping[str, str]], dict[str, Any]],
    names: Mapping[str, str],
) -> int:
    """How many rows of the table had the name."""
    changed, query = [], select(table)
    if table is schema.state:
        # or an older state would be put over one that a server writes meanwhile
        query = query.with_for_update()
    for row in connection.execute(query.execution_options(yield_per=1000)).mappings():
        values = change(row, names)
        if any(values[column] != row[column] for column in values):
            changed.append((row["id"], values))
    for number, values in changed:
        connection.execute(update(table).where(table.c.id == number).values(values))
    return len(changed)


def _remembered(saved: Mapping[str, Any]) -> set[str]:
    """Whoever the game may name again and who is not here: who is here counts as new."""
    met: set[str] = set()

    def note(name: str) -> str:
        met.add(name)
        return name

    _rename_in_state(saved, note)
    return met - _names(saved, "users", "queue")


def _names(saved: Mapping[str, Any], *lists: str) -> set[str]:
    return {one["name"] for part in lists for one in saved.get(part, ())}


def _digest(name: str) -> str:
    return hashlib.sha256(name.encode()).hexdigest()


def _neutral(number: int) -> str:
    return f"player {number}"
