"""Deleting a player's data: battles stay, and another name stands where the player's was.

Works beside servers that run. Each may still show the player in its last result, and would write the name again:
until it has a new result, it is told by the table `forgotten` what to write instead.
"""

import hashlib
import re
import time
import unicodedata
from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, Table, insert, select, update

from server.game.users import is_valid_name
from server.store import schema

_TEXTS = frozenset({"cause", "how", "notice", "text", "message"})  # sentences that may have a name among their words
_KEPT = frozenset({"caller", "session"})  # never a player's name, though they may look like it


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
    changed = 0
    for table, columns in (
        (schema.fighters, ("name",)),
        (schema.events, ("data",)),
        (schema.battles, ("cause", "result")),
        (schema.state, ("data",)),
    ):
        changed += _rename(connection, table, columns, {name: neutral})
    if not changed:
        raise nobody
    return neutral


def find_forgotten(connection: Connection, saved: Mapping[str, Any], arena: str) -> dict[str, str]:
    """What is to be written instead of names that the game in `saved`, the arena's, still remembers, though they were
    deleted."""
    pending = connection.execute(select(schema.forgotten).where(schema.forgotten.c.digest.is_not(None))).all()
    rows = [row for row in pending if arena in (row.arenas or [""])]
    shooters = {one["by"] for one in saved.get("happened", ())}
    remembered = (_names(saved, "result", "leavers", "happened") | shooters) - _names(
        saved, "users", "queue"
    )  # whoever is here counts as new
    by_digest = {_digest(name): name for name in remembered} if rows else {}
    found = {by_digest[row.digest]: _neutral(row.id) for row in rows if row.digest in by_digest}
    for row in rows:
        if row.digest not in by_digest:
            arenas = [other for other in row.arenas or () if other != arena]
            values = {"arenas": arenas, "digest": row.digest if arenas else None}
            connection.execute(update(schema.forgotten).where(schema.forgotten.c.id == row.id).values(values))
    return found


def renamed(data: Any, names: Mapping[str, str], key: str = "") -> Any:
    """`data`, of JSON's types, with these names replaced; `key` is the one under which it stands."""
    if not names or key in _KEPT:
        return data
    if isinstance(data, Mapping):
        return {name: renamed(value, names, name) for name, value in data.items()}
    if isinstance(data, list | tuple):
        return [renamed(value, names, key) for value in data]
    if not isinstance(data, str):
        return data
    if key in _TEXTS:
        for name, neutral in names.items():
            data = _rename_words(data, name, neutral)
        return data
    return names.get(data, data)


def _rename(connection: Connection, table: Table, columns: Sequence[str], names: Mapping[str, str]) -> int:
    """How many rows of the table had the name."""
    changed = []
    for row in connection.execute(select(table).execution_options(yield_per=1000)).mappings():
        values = {column: renamed(row[column], names, column) for column in columns}
        if any(values[column] != row[column] for column in columns):
            changed.append((row["id"], values))
    for number, values in changed:
        connection.execute(update(table).where(table.c.id == number).values(values))
    return len(changed)


def _rename_words(text: str, name: str, neutral: str) -> str:
    """The name is replaced where it is not a part of a longer one."""

    def replaced(found: re.Match[str]) -> str:
        neighbours = text[: found.start()][-1:], text[found.end() :][:1]
        return name if any(map(_belongs_to_name, neighbours)) else neutral

    return re.sub(re.escape(name), replaced, text)


def _belongs_to_name(char: str) -> bool:
    return bool(char) and (char == "_" or unicodedata.category(char)[0] in "LMN")


def _names(saved: Mapping[str, Any], *lists: str) -> set[str]:
    return {one["name"] for part in lists for one in saved.get(part, ())}


def _digest(name: str) -> str:
    return hashlib.sha256(name.encode()).hexdigest()


def _neutral(number: int) -> str:
    return f"player {number}"
