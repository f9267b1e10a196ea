"""What was decided, kept: events, battles, robots' IDs and the newest state of the game.

The game never waits for the database and does not end with it: what is to be written waits in memory until it can be.
A driver's errors are of many kinds, and none of them is the game's: here every exception is a fault of the database.
"""

import logging
import math
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from sqlalchemy import URL, Connection, Engine, Row, Table, create_engine, delete, event, func, insert, select, update
from sqlalchemy.exc import DatabaseError
from sqlalchemy.pool import ConnectionPoolEntry

from server.game import events
from server.game.events import Recorded, from_json, kind_of, to_json
from server.game.persistence import mend
from server.store import schema, versions
from server.store.backup import bring_back
from server.store.clocks import Clocks
from server.store.fighters import Outcome, keep_fighters
from server.store.forget import find_forgotten, rename_in_event, rename_in_state
from server.store.held import UNSEEN, FileId, Held, file_id
from server.store.tally import tally, tally_left_over
from server.store.track import Piece

_log = logging.getLogger(__name__)

MAX_WAITING = 20_000  # events that wait for a database that is away; a battle has some hundred
MAX_PIECES = 60  # of tracks that wait, too: about ten minutes
WRITTEN_AGAIN = "the database can be written again"
RETRY = 1.0  # s between attempts
TALLY_AGAIN = 300.0  # s until older battles are added up again, when that has failed
LOOK = 2.0  # s between looks at the file while nothing is to be written
TOLD_FOR = 600.0  # s
CLOSE_WITHIN = 1.0  # s
CLOCK = "clock"  # in the saved state: when that was saved, see `clock_of`
_SECRET = ("session", "key", "address")  # of events: nobody needs them any more, and they are personal
_BUSY = 3.0  # s that a statement may wait for another program, and for a server's answer
_BROKEN = (sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_CORRUPT)
# besides, of a file that was in order before: what it should have is not there any more
_OVERWRITTEN = (*_BROKEN, sqlite3.SQLITE_CONSTRAINT_FOREIGNKEY)


@dataclass(frozen=True)
class _Attempt:
    """A transaction that may be committed although it failed: a server can do what it was told and not say so."""

    newest: int  # ID of the newest event before it, 0 for none
    last: Recorded  # of those that it would have added
    battle: int | None  # row of the one that runs after it


class _State(NamedTuple):
    """Of the game."""

    data: Mapping[str, Any]
    at: float  # Unix time in s


@dataclass(frozen=True)
class Kept:
    """What an earlier program has left."""

    robots: Mapping[str, int] = field(default_factory=dict)  # IDs by ROS names
    battles: int = 0  # number of the last one
    state: Mapping[str, Any] | None = None  # see server.game.persistence
    saved_at: float = 0.0  # monotonic s of this program


class AwayError(Exception):
    """The database cannot be read now; why."""


class Database:
    """Of one arena, which may share it with others: see schema.py. A thread of its own writes. `problem` says why it
    cannot, "" while it can. `replacements` counts how often its file was deleted, replaced or overwritten."""

    def __init__(self, url: URL, arena: str = "", clocks: Clocks | None = None, look: float = LOOK) -> None:
        self.arena = arena
        self.problem = ""
        self.replacements = 0
        self.found: Callable[[Kept], None] = lambda kept: None  # told what is there, when it could not be read before
        self._unread = False
        self._url = url
        self._path = Path(url.database) if self._is_file and url.database else None
        self._clocks = clocks or Clocks()
        self._engine = make_engine(url)
        self._changed = threading.Condition()
        # what waits has Unix times, by the clock of the battle: as the wall's clock was set when the battle began
        self._waiting: list[Recorded] = []
        self._in_hand = 0  # of what waits, what the thread is about to write
        self._saved: _State | None = None
        self._newest: _State | None = None  # whether it is written or not
        self._pieces: list[tuple[Piece, float]] = []  # and what makes their times Unix times
        self._offset = self._clocks.offset()  # of the battle's clock; of the last one's while none runs
        self._fighting = False
        self._battle: int | None = None  # row of the one that runs, as far as it is written
        self._unsure: _Attempt | None = None
        self._last_event: int | None = None  # ID of the newest that is written; None: has to be asked for
        self._look_every = look if self._path else None
        self._file: FileId | None = None  # that is open
        self._held = Held()
        self._is_left_over = True  # there may be battles that are not in the table of standings
        self._tally_from = -math.inf  # monotonic s
        self._is_anew = False  # what is held is still to be written to another file than before
        self._mishap, self._mishap_at = "", 0.0
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="database", daemon=True)

    def open(self, patience: float = 0.0) -> Kept:
        """What is there. A file that is no database is put aside; any other failure is logged, and nothing is there.

        A server that cannot be reached may just be starting: for `patience` s it is asked again.
        """
        end = time.monotonic() + patience
        while (kept := self._try_load()) is None and not self._is_file and time.monotonic() < end:
            time.sleep(RETRY)
        self._unread = kept is None
        kept = kept or Kept()
        if self._battle is not None and kept.state is not None:
            self._offset, self._fighting = kept.state[CLOCK]["battle"] - kept.saved_at, True
        self._thread.start()
        return kept

    def keep_robots(self, ids: Mapping[str, int]) -> None:
        """Add IDs by ROS names, which are not there yet. A failure is logged."""
        self._held.keep_robots(ids)
        try:
            with self._transaction() as connection:
                for caller, robot in ids.items():
                    _keep_robot(connection, self.arena, caller, robot)
        except Exception as error:
            self._tell(error)

    def record(self, recorded: Sequence[Recorded], saved: Mapping[str, Any]) -> None:
        """Keep these events, and the state after them. Does not block; from one thread."""
        with self._changed:
            self._waiting += self._dated(recorded)
            mark = self._clocks.mark()
            clock = mark | {"battle": mark["monotonic"] + self._offset}
            self._saved = self._newest = _State({**saved, CLOCK: clock}, mark["unix"])
            if len(self._waiting) > MAX_WAITING:
                del self._waiting[: len(self._waiting) - MAX_WAITING]
            self._changed.notify()

    def keep_piece(self, piece: Piece) -> None:
        """Keep a piece of the track of the newest battle of that number. Does not block."""
        with self._changed:
            self._pieces = [*self._pieces, (piece, self._offset)][-MAX_PIECES:]
            self._changed.notify()

    @property
    def waiting(self) -> int:
        """How many events are not yet written."""
        with self._changed:
            return len(self._waiting) + self._in_hand

    @property
    def mishap(self) -> str:
        """What happened to the file, and what was done, for some minutes; "" if nothing did."""
        return self._mishap if self._clocks.monotonic() - self._mishap_at < TOLD_FOR else ""

    @property
    def version(self) -> str:
        """Of what keeps it, as far as that is known."""
        numbers = self._engine.dialect.server_version_info or ()
        return " ".join([self._url.get_backend_name(), ".".join(map(str, numbers))]).strip()

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """For any thread. AwayError if it cannot be read now."""
        if self._is_other_file():  # opening it here would make a new one
            raise AwayError("its file was deleted or replaced")
        try:
            with self._engine.connect() as connection:
                yield connection
        except Exception as error:
            raise AwayError(reason_of(error)) from error

    def close(self) -> None:
        """Write what waits, if that is possible soon, and end."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join(CLOSE_WITHIN)
        self._engine.dispose()

    def _dated(self, recorded: Sequence[Recorded]) -> list[Recorded]:
        """With Unix times. In a battle its clock goes on as it was set at the beginning, whatever is done to it."""
        dated, offset = [], self._clocks.offset()
        for one in recorded:
            if isinstance(one.event, events.BattleStarted):
                self._offset, self._fighting = offset, True
            dated.append(Recorded(one.at + (self._offset if self._fighting else offset), one.event))
            if isinstance(one.event, events.BattleEnded):
                self._fighting = False
        return dated

    # the thread

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._saved or self._pieces or self._closing, self._look_every)
                recorded, saved, pieces = self._waiting, self._saved, self._pieces
                self._waiting, self._saved, self._pieces, self._in_hand = [], None, [], len(recorded)
            self._look(recorded)
            if self._is_anew:
                saved = saved or self._newest
            written = not (saved or pieces or self._is_anew) or self._write(recorded, saved, pieces)
            with self._changed:
                self._in_hand = 0
                if not written:
                    self._waiting = (recorded + self._waiting)[-MAX_WAITING:]
                    self._saved = self._saved or saved
                    self._pieces = (pieces + self._pieces)[-MAX_PIECES:]
                    self._changed.wait_for(lambda: self._closing, RETRY)
                if self._closing and not (written and (self._saved or self._pieces)):
                    return

    def _look(self, recorded: list[Recorded]) -> None:
        """If another file is where the open one was, or none, go over to that."""
        if self._path is None or not self._is_other_file():
            return
        if file_id(self._path) is not None:
            self._begin_anew("replaced", recorded)
            return
        try:
            with self._engine.connect() as connection:
                held: Any = connection.connection.driver_connection
                if connection.info["file"] != self._file:
                    raise LookupError("no connection was open")
                bring_back(held, self._path)
        except Exception as error:
            _log.warning("%s cannot be brought back: %s", self._path, reason_of(error))
            self._begin_anew("deleted", recorded)
        else:
            self._engine.dispose()
            self._file = file_id(self._path)
            self._tell_mishap("deleted", "all that was in it has been written there again")

    def _begin_anew(self, what: str, recorded: list[Recorded]) -> None:
        """The file is lost, and with it the battle that runs: it is written once more, before `recorded`."""
        self._engine.dispose()
        self._file, self._battle, self._unsure, self._last_event, self._is_anew = None, None, None, None, True
        recorded[:0] = self._held.take_battle()
        # first, so that nobody who hears of the mishap takes it for mended
        self.problem = f"its file was {what} while it was open"
        self._tell_mishap(what, "what this program holds is written to the file that is there now, or to a new one")

    def _tell_mishap(self, what: str, done: str) -> None:
        self.replacements += 1
        self._mishap, self._mishap_at = f"{self._path} was {what} while it was open: {done}", self._clocks.monotonic()
        _log.error("%s", self._mishap)

    def _write(self, recorded: list[Recorded], saved: _State | None, pieces: Sequence[tuple[Piece, float]]) -> bool:
        """Whether it could be done. What turns out to be there already is taken out of `recorded`."""
        if (self._unread or self._is_anew) and not self._read():
            return False
        try:
            with self._transaction() as connection:
                if self.problem:
                    versions.prepare(connection)
                battle, last_event = self._battle, self._last_event
                if self._is_anew:
                    for caller, robot in self._held.robots.items():
                        _keep_robot(connection, self.arena, caller, robot)
                if saved:
                    battle, last_event = self._write_events(connection, recorded, saved)
                for piece, offset in pieces:
                    _keep_piece(connection, self.arena, piece, offset)
        except Exception as error:
            if isinstance(error, DatabaseError) and self._has_code(error, _OVERWRITTEN) and not self._is_anew:
                self._begin_anew(f"overwritten ({reason_of(error)})", recorded)
                return False
            self._tell(error)
            self._engine.dispose()  # a connection that was given up may still get the answer
            self._last_event = None  # this attempt, or the one before it, may have been committed all the same
            return False
        self._held.keep(recorded)
        self._battle, self._last_event, self._unsure, self._is_anew = battle, last_event, None, False
        if self.problem:
            _log.warning(WRITTEN_AGAIN)
        self.problem = ""
        self._tally()
        return True

    def _tally(self) -> None:
        """Some of what an older program has written, in a transaction of its own: a battle does not need it."""
        if self._is_left_over and self._clocks.monotonic() >= self._tally_from:
            try:
                with self._transaction() as connection:
                    self._is_left_over = tally_left_over(connection)
            except Exception as error:
                self._tally_from = self._clocks.monotonic() + TALLY_AGAIN
                _log.warning(
                    "older battles are not in the table of standings yet (%s): tried again in %.0f min",
                    reason_of(error),
                    TALLY_AGAIN / 60,
                )

    def _read(self) -> bool:
        """Open what could not be read before. Whether it may be written over now."""
        kept = self._try_load()
        if kept is None:
            return False
        self._battle = None  # the one that runs is none that it has
        if self._is_anew:
            return True
        self._unread = False
        _log.warning(WRITTEN_AGAIN)
        if kept.state is not None:
            try:
                self.found(kept)
            except Exception:
                _log.exception("what the database had could not be taken over")
            return False  # the next state has what was found
        return True

    def _write_events(self, connection: Connection, recorded: list[Recorded], saved: _State) -> tuple[int | None, int]:
        """Returns the row of the battle that runs after them, and the ID of the newest event. Few statements: each is
        a round trip to a server, and others wait meanwhile for what is locked."""
        _keep_state(connection, self.arena, saved)  # first, since it waits for an earlier attempt to end
        last = self._last_event
        if last is None:
            ids, arenas = schema.events.c.id, schema.events.c.arena
            last = connection.scalar(select(func.max(ids)).where(arenas == self.arena)) or 0
        if self._unsure and last > self._unsure.newest:
            rest = _after(self._unsure.last, recorded)
            self._held.keep(recorded[: len(recorded) - len(rest)])
            self._battle, recorded[:], self._unsure = self._unsure.battle, rest, None
        battle, before = self._battle, last
        forgotten = find_forgotten(connection, saved.data, self.arena)
        for one in recorded:
            battle, last = _keep(connection, one, battle, forgotten, arena=self.arena)
        if forgotten:
            _keep_state(connection, self.arena, saved._replace(data=rename_in_state(saved.data, forgotten)))
        if recorded:
            self._unsure = _Attempt(before, recorded[-1], battle)
        return battle, last

    def _try_load(self) -> Kept | None:
        try:
            try:
                kept = self._load()
            except DatabaseError as error:
                if not self._has_code(error, _BROKEN):
                    raise
                self._put_aside(error)
                kept = self._load()
        except Exception as error:
            self._tell(error)
            self._engine.dispose()
            return None
        self._file = file_id(self._path)
        if not self._is_anew:
            self._held.keep_robots(kept.robots)
            self.problem = ""
        return kept

    def _load(self) -> Kept:
        with self._transaction() as connection:
            versions.prepare(connection)
            state, robots = schema.state.c, schema.robots.c
            row = connection.execute(select(state.at, state.data).where(state.arena == self.arena)).first()
            known = connection.execute(select(schema.robots).where(robots.arena == self.arena))
            last = _last_battle(connection, self.arena)
            if row and last and last.ended is None and last.number == row.data.get("battle"):
                self._battle = last.id
                self._held.keep(_events_of(connection, last.id))
            kept = Kept({row.caller: row.robot for row in known}, last.number if last else 0)
            if row is None:
                return kept
            mark = clock_of(row.at, row.data.get(CLOCK))
            saved_at = self._clocks.monotonic() - self._clocks.age(mark)
            return replace(kept, state=_mended(row.data) | {CLOCK: mark}, saved_at=saved_at)

    @property
    def _is_file(self) -> bool:
        return self._url.get_backend_name() == "sqlite"

    def _is_other_file(self) -> bool:
        return self._file is not None and file_id(self._path) not in (self._file, UNSEEN)

    @contextmanager
    def _transaction(self) -> Iterator[Connection]:
        if self._path:
            self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._engine.begin() as connection:
            yield connection

    def _tell(self, error: Exception) -> None:
        reason = reason_of(error)
        if not self.problem:
            _log.error("the database %s cannot be used (%s): the game goes on without it", self._url, reason)
        self.problem = reason

    def _has_code(self, error: DatabaseError, codes: tuple[int, ...]) -> bool:
        return self._path is not None and getattr(error.orig, "sqlite_errorcode", None) in codes

    def _put_aside(self, error: DatabaseError) -> None:
        self._engine.dispose()
        path = Path(self._url.database or "")
        _log.error("%s is broken (%s): kept as %s.broken, and begun anew", path, error.orig, path.name)
        for suffix in ("", "-wal", "-shm"):
            part = path.with_name(path.name + suffix)
            if part.exists():
                part.replace(part.with_name(f"{path.name}.broken{suffix}"))


def clock_of(saved_at: float, told: Mapping[str, Any] | None) -> dict[str, Any]:
    """When the state was saved, see Clocks.mark, and `battle`: the Unix time in s by the clock of its battle. Older
    programs tell nothing but the time of saving it."""
    return {"unix": saved_at, "battle": saved_at, **(told or {})}


def _mended(saved: Mapping[str, Any]) -> dict[str, Any]:
    mended, faults = mend(saved)
    for fault in faults:
        _log.warning("found in the database: %s", fault)
    return dict(mended)


def reason_of(error: BaseException) -> str:
    """In one line, by the part that knows: the file's library, the server or the network."""
    cause = getattr(error, "orig", None) or error
    if cause.args and isinstance(cause.args[0], dict):  # the fields of PostgreSQL's error message
        return str(cause.args[0].get("M", cause))
    reason = f"{cause}, {cause.__cause__}" if isinstance(cause.__cause__, OSError) else str(cause)
    return " ".join(reason.split()) or type(cause).__name__


def _after(last: Recorded, recorded: list[Recorded]) -> list[Recorded]:
    """What comes after `last`; all, when that is too old to be among them."""
    places = [place for place, one in enumerate(recorded) if one is last]
    return recorded[places[0] + 1 :] if places else recorded


def _last_battle(connection: Connection, arena: str) -> Row[Any] | None:
    """The newest of that arena."""
    battles = schema.battles.c
    newest = select(schema.battles).where(battles.arena == arena).order_by(battles.id.desc())
    return connection.execute(newest.limit(1)).first()


def _keep_state(connection: Connection, arena: str, state: _State) -> None:
    table, news = schema.state, {"at": state.at, "data": state.data}
    if not connection.execute(update(table).where(table.c.arena == arena).values(news)).rowcount:
        connection.execute(insert(table).values(arena=arena, **news))


def _keep(
    connection: Connection,
    recorded: Recorded,
    battle: int | None,
    forgotten: Mapping[str, str],
    *,
    arena: str,
) -> tuple[int | None, int]:
    """Write one event, which has a Unix time; returns the row of the battle that runs after it, and the event's ID."""
    decided, at = recorded.event, recorded.at
    match decided:
        case events.RobotLinked(robot, True, caller) if caller:  # a name alone is not a robot
            _keep_robot(connection, arena, caller, robot)
        case events.BattleStarted(number):
            battle = _added(connection, schema.battles, arena=arena, number=number, began=at)
    kind = kind_of(decided)
    fields = rename_in_event(kind, to_json(decided), forgotten)
    fields |= {name: "" for name in _SECRET if hasattr(decided, name)}
    written = _added(connection, schema.events, arena=arena, at=at, battle=battle, kind=kind, data=fields)
    if isinstance(decided, events.BattleStarted) and battle is not None:
        keep_fighters(connection, battle, Outcome(at))
    if isinstance(decided, events.BattleEnded):
        if battle is not None:
            _end_battle(connection, battle, at, fields)
        battle = None
    return battle, written


def _end_battle(connection: Connection, battle: int, at: float, fields: Mapping[str, Any]) -> None:
    """`fields`: of the event."""
    cause, result, counts = fields["cause"], fields["result"], fields.get("counts", True)
    battles = schema.battles
    ended = update(battles).where(battles.c.id == battle).values(ended=at, cause=cause, result=result, counts=counts)
    began = connection.execute(ended.returning(battles.c.began)).scalar_one()
    keep_fighters(connection, battle, Outcome(began, at, result))
    tally(connection, battle)


def _added(connection: Connection, table: Table, **values: Any) -> int:
    """The ID of the new row."""
    made = connection.execute(insert(table).values(values)).inserted_primary_key
    assert made
    return int(made[0])


def _events_of(connection: Connection, battle: int) -> Iterator[Recorded]:
    """With Unix times."""
    events = schema.events.c
    for row in connection.execute(select(schema.events).where(events.battle == battle).order_by(events.id)):
        with suppress(ValueError):  # of another version of this program
            yield Recorded(row.at, from_json(row.kind, row.data))


def _keep_piece(connection: Connection, arena: str, piece: Piece, offset: float) -> None:
    """What has no battle is left out: the battle's beginning was lost while the database was away."""
    battles = schema.battles.c
    same = select(battles.id, battles.began).where(battles.arena == arena, battles.number == piece.battle)
    if row := connection.execute(same.order_by(battles.id.desc()).limit(1)).first():
        connection.execute(insert(schema.tracks).values(battle=row.id, data=piece.to_json(row.began - offset)))


def _keep_robot(connection: Connection, arena: str, caller: str, robot: int) -> None:
    robots = schema.robots.c
    same = (robots.caller == caller) | (robots.robot == robot)
    connection.execute(delete(schema.robots).where(robots.arena == arena, same))
    connection.execute(insert(schema.robots).values(arena=arena, caller=caller, robot=robot))


def make_engine(url: URL, busy: float = _BUSY, kept: int = 1) -> Engine:
    """By which the database at `url` is written and read. `busy`: s that a statement may wait for another program, and
    for a server's answer. A server has some hundred connections for all arenas: of each engine at most `kept` stay,
    others end with what they were made for."""
    if url.get_backend_name() != "sqlite":
        # it writes a traceback for each connection that the other end has broken; what is wrong is told by us, once
        logging.getLogger("sqlalchemy.pool").setLevel(logging.CRITICAL)
        return create_engine(url, connect_args={"timeout": busy}, pool_pre_ping=True, pool_size=kept, max_overflow=9)
    engine = create_engine(url, connect_args={"timeout": busy})

    @event.listens_for(engine, "connect")
    def settle(connection: Any, record: ConnectionPoolEntry) -> None:
        record.info["file"] = file_id(Path(url.database) if url.database else None)
        # a commit outlives the program by the log alone; only a power cut may take the last ones
        try:
            connection.execute("PRAGMA journal_mode=WAL")
            connection.execute("PRAGMA synchronous=NORMAL")
            connection.execute("PRAGMA foreign_keys=ON")
        except sqlite3.Error:
            connection.close()  # nobody else would
            raise

    return engine
