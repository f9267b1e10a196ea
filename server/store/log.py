"""What was decided, for people: the newest events from memory, all of them from the database."""

import csv
import io
import json
import threading
import time
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

from sqlalchemy import select

from server.game.events import Recorded, from_json, kind_of
from server.store import schema
from server.store.csv_safety import harmless
from server.store.database import AwayError, Database

NEWEST = 50
_PAGE = 500  # events read at once

Entry = dict[str, Any]  # at: Unix time in s, kind, text, by: operator's name or None; from the database data, too


class EventLog:
    """Thread-safe."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._lock = threading.Lock()
        self._newest: deque[Entry] = deque(maxlen=NEWEST)

    def open(self) -> None:
        """Take over the newest events of an earlier program, if the database can be read."""
        events = schema.events.c
        try:
            with self._database.reading() as connection:
                newest = select(schema.events).where(events.arena == self._database.arena).order_by(events.id.desc())
                rows = connection.execute(newest.limit(NEWEST)).all()
        except AwayError:
            return  # the database has said why
        for row in reversed(rows):
            entry = _entry(row.at, row.kind, row.data)
            del entry["data"]
            self._newest.append(entry)

    def record(self, recorded: Sequence[Recorded], _saved: Mapping[str, Any]) -> None:
        """A recorder of the game."""
        offset = time.time() - time.monotonic()
        with self._lock:
            for one in recorded:
                by = getattr(one.event, "by", "") or None
                entry = {"at": one.at + offset, "kind": kind_of(one.event), "text": str(one.event), "by": by}
                self._newest.append(entry)

    def latest(self) -> list[Entry]:
        """The newest first."""
        with self._lock:
            return list(reversed(self._newest))

    def read(self) -> Iterator[Entry]:
        """All that the database has, oldest first, in small steps: nobody waits for a slow reader. AwayError, at the
        call or, if the database goes away in between, later."""
        entries = self._pages()
        first = next(entries, None)
        return entries if first is None else chain([first], entries)

    def _pages(self) -> Iterator[Entry]:
        events, last = schema.events.c, 0
        while True:
            with self._database.reading() as connection:
                own = select(schema.events).where(events.arena == self._database.arena, events.id > last)
                rows = connection.execute(own.order_by(events.id).limit(_PAGE)).all()
            if not rows:
                return
            for row in rows:
                yield _entry(row.at, row.kind, row.data)
            last = rows[-1].id


def as_json(entries: Iterable[Entry]) -> Iterator[str]:
    """A list, a line for each."""
    before = "[\n"
    for entry in entries:
        yield before + json.dumps(entry)
        before = ",\n"
    yield "[]\n" if before == "[\n" else "\n]\n"


def as_csv(entries: Iterable[Entry]) -> Iterator[str]:
    """A table, with the data as JSON."""
    columns = ("at", "kind", "text", "by", "data")
    yield ",".join(columns) + "\r\n"
    for entry in entries:
        line = io.StringIO()
        cells = {**entry, "by": entry["by"] or "", "data": json.dumps(entry["data"])}
        csv.writer(line).writerow([harmless(cells[column]) for column in columns])
        yield line.getvalue()


def _entry(at: float, kind: str, data: Mapping[str, Any]) -> Entry:
    """Without sessions: with those one could act for a player."""
    shown = {name: value for name, value in data.items() if name != "session"}
    try:
        text = str(from_json(kind, data))
    except ValueError:  # of another version of this program
        text = ""
    return {"at": at, "kind": kind, "text": text, "by": data.get("by") or None, "data": shown}
