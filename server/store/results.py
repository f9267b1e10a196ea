"""What was played: battles and the leaderboard, read beside the thread that writes (see database.py)."""

import math
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any

from sqlalchemy import (
    URL,
    ColumnElement,
    Connection,
    Engine,
    NullPool,
    Row,
    Select,
    cast,
    create_engine,
    exists,
    func,
    literal_column,
    select,
    union_all,
)
from sqlalchemy.exc import SQLAlchemyError

from laser_bot_battle.names import Game
from server.game.persistence import restore_tournament
from server.game.tournament_view import tournament_view
from server.store import schema
from server.store.clocks import Clocks
from server.store.course import Course
from server.store.database import CLOCK, AwayError, clock_of, make_engine
from server.store.fighters import read_courses
from server.store.marks import ON_FLOOR, ON_HILLS, ON_ROBOTS, effects, marks, points
from server.store.tally import COUNTS, SHOOTING, is_left_over, sums
from server.store.track import join

MAX_PLAYERS = 500  # in a leaderboard
_READERS = 2  # at a time: a database that is away does not hold up the pages that need none
_TURN_WITHIN = 2.0  # s to wait for one's turn
_BUSY = 1.0  # s that a query may wait for a program that holds the file
_IDLE = 3.0  # s after its last use that a connection to a server is closed: to log in takes longer than most queries
_COUNT_AGAIN = 60.0  # s until all battles are counted anew; of a million that takes longer than reading a page of them


class BusyError(Exception):
    """Too many read at the same time."""


@dataclass(frozen=True, slots=True)
class Fighter:
    """One player's part in a battle; times in s."""

    name: str
    robot: int
    avatar: int
    place: int | None  # None: the battle has no result
    life: int
    left: bool  # before the end
    hits: int  # taken
    seconds: float  # until death, leaving or the end
    team: int | None  # 0: fought alone
    shots: int | None  # fired; None: nobody has counted
    given: int | None  # hits; None: the light did not tell whose all were
    kills: int | None  # likewise

    @property
    def accuracy(self) -> float | None:
        return accuracy(self.given, self.shots)


@dataclass(frozen=True, slots=True)
class Battle:
    """Times are Unix times in s."""

    id: int
    number: int  # for people, not unique
    began: float
    ended: float | None
    cause: str | None  # of the end
    counts: bool  # False: aborted
    so_far: float | None  # s that it has lasted, if it runs; one that neither runs nor has ended was cut off
    arena: str  # "" where only one uses the database
    fighters: tuple[Fighter, ...]  # best first

    @property
    def running(self) -> bool:
        return self.so_far is not None

    @property
    def seconds(self) -> float | None:
        return None if self.ended is None else max(0.0, self.ended - self.began)


@dataclass(frozen=True, slots=True)
class Standing:
    """One line of the leaderboard: battles that count."""

    place: int
    name: str
    battles: int
    wins: int  # first places, shared ones too
    hits: int  # taken
    seconds: float  # played
    # of the battles of which it is known, None if there is none
    shots: int | None  # fired
    given: int | None  # hits
    kills: int | None
    accuracy: float | None  # share of the shots that have met somebody


def accuracy(given: int | None, shots: int | None) -> float | None:
    """The share of the shots that have met somebody; None if that is not known. A shot may meet two."""
    return min(1.0, given / shots) if given is not None and shots else None


@dataclass(frozen=True, slots=True)
class Count:
    """Of all battles: `now` counts those that have come since, and all of them once a minute."""

    battles: int = 0
    last: int = 0  # ID of the newest of them
    began: float = -math.inf  # monotonic s, when all were counted; since then only new ones

    def now(self, connection: Connection, now: float) -> "Count":
        known = self if now - self.began < _COUNT_AGAIN else Count(began=now)
        ids = schema.battles.c.id
        more, last = connection.execute(select(func.count(), func.max(ids)).where(ids > known.last)).one()
        return replace(known, battles=known.battles + more, last=last or known.last)


class Results:
    """Thread-safe. Each method raises AwayError or BusyError when it cannot answer now."""

    def __init__(self, url: URL, clocks: Clocks | None = None) -> None:
        self._engine = _reader(url)
        self._files = _files(url)
        self._clocks = clocks or Clocks()
        self._turns = threading.BoundedSemaphore(_READERS)
        self._users = 0  # of a server
        self._closer = threading.Timer(_IDLE, self._close_unused)
        self._closing = threading.Lock()
        self._count = Count()

    def close(self) -> None:
        """The connection to a server."""
        with self._closing:
            self._closer.cancel()
            self._engine.dispose()

    def mark(self) -> object:
        """What is another one after each change; None where that is not known."""
        return tuple(map(_look, self._files)) or None

    def battles(self, page: int, size: int) -> tuple[list[Battle], int]:
        """Those of a page, newest first (page 1 has the newest), and how many there are in all."""
        with self._reading() as connection:
            # a file is quickly counted, and another one may be in its place
            known = Count() if self._files else self._count
            self._count = count = known.now(connection, time.monotonic())
            rows = connection.execute(
                select(schema.battles).order_by(schema.battles.c.id.desc()).limit(size).offset((page - 1) * size)
            ).all()
            return _with_fighters(connection, rows, self._clocks), count.battles

    def battle(self, battle: int) -> tuple[Battle, list[Course]] | None:
        """The battle with that ID and how it went, None if there is none."""
        with self._reading() as connection:
            rows = connection.execute(select(schema.battles).where(schema.battles.c.id == battle)).all()
            if not rows:
                return None
            return _with_fighters(connection, rows, self._clocks)[0], read_courses(connection, battle)

    def has_track(self, battle: int) -> bool:
        """Whether it is known where the robots were in that battle."""
        with self._reading() as connection:
            return bool(connection.scalar(select(exists().where(schema.tracks.c.battle == battle))))

    def track(self, battle: int) -> dict[str, Any] | None:
        """Where the robots were in that battle, see server.store.track.join."""
        tracks = schema.tracks.c
        with self._reading() as connection:
            return join(connection.scalars(select(tracks.data).where(tracks.battle == battle).order_by(tracks.id)))

    def places(self, battle: int) -> list[dict[str, Any]]:
        """What was on the floor in that battle, see server.store.marks."""
        with self._reading() as connection:
            return marks(_events(connection, battle, ON_FLOOR))

    def effects(self, battle: int) -> list[dict[str, Any]]:
        """What worked for whom in that battle, see server.store.marks."""
        with self._reading() as connection:
            return effects(_events(connection, battle, ON_ROBOTS))

    def points(self, battle: int) -> list[dict[str, Any]]:
        """Who was on a hill in that battle, see server.store.marks."""
        with self._reading() as connection:
            return points(_events(connection, battle, ON_HILLS))

    def leaderboard(self, begin: float, end: float) -> list[Standing]:
        """The most wins, in battles that began from `begin` to before `end`; equals by fewer hits per battle."""
        began = schema.battles.c.began
        with self._reading() as connection:
            return _best(connection, sums().where(began >= begin, began < end))

    def standings(self) -> list[Standing]:
        """The same of all battles, which are added up already, but for those that an older program has written."""
        added = all_standings()
        with self._reading() as connection:
            if not connection.scalar(select(exists().where(is_left_over()))):
                return _best(connection, added)
            both = union_all(added, sums().where(is_left_over())).subquery().c
            # PostgreSQL's sum of its large integers is numeric, which JSON has no word for
            totals = (cast(func.sum(both[name]), both[name].type).label(name) for name in (*COUNTS, *SHOOTING))
            return _best(connection, select(both.name, *totals).group_by(both.name))

    def winners(self, begin: float, end: float) -> list[list[tuple[str, bool]]]:
        """Of each battle that counts and began from `begin` to before `end`, the oldest first: who fought, and whether
        they won."""
        fighters, battles = schema.fighters.c, schema.battles.c
        query = (
            select(fighters.battle, fighters.name, fighters.place)
            .join(schema.battles, battles.id == fighters.battle)
            .where(battles.began >= begin, battles.began < end, battles.counts, battles.ended.is_not(None))
            .order_by(fighters.battle)
        )
        with self._reading() as connection:
            rows = connection.execute(query).all()
        return [
            [(row.name, row.place == 1) for row in rows_of_one]
            for _, rows_of_one in groupby(rows, lambda row: row.battle)
        ]

    def tournament(self, arena: str) -> dict[str, Any] | None:
        """As people see it, see server.game.tournament_view; of that arena, None without one."""
        with self._reading() as connection:
            data = connection.scalar(select(schema.state.c.data).where(schema.state.c.arena == arena)) or {}
        found = restore_tournament(data.get("tournament"), 0.0)
        return tournament_view(found, data.get("lengths", ())) if found else None

    @contextmanager
    def _reading(self) -> Iterator[Connection]:
        if not self._turns.acquire(timeout=_TURN_WITHIN):
            raise BusyError
        try:
            with nullcontext() if self._files else self._using_server(), self._engine.connect() as connection:
                yield connection
        except (SQLAlchemyError, OSError) as error:
            raise AwayError(str(getattr(error, "orig", None) or error)) from error
        finally:
            self._turns.release()

    @contextmanager
    def _using_server(self) -> Iterator[None]:
        """A server has some hundred connections for all arenas, so one that nobody uses is given back after a while."""
        with self._closing:
            self._users += 1
            self._closer.cancel()
        try:
            yield
        finally:
            with self._closing:
                self._users -= 1
                if not self._users:
                    self._closer = threading.Timer(_IDLE, self._close_unused)
                    self._closer.daemon = True
                    self._closer.start()

    def _close_unused(self) -> None:
        with self._closing:
            if not self._users:
                self._engine.dispose()


def all_standings() -> Select[Any]:
    """Each player's totals of the battles that are added up already."""
    return select(*(schema.standings.c[name] for name in ("name", *COUNTS, *SHOOTING)))


def _best(connection: Connection, totals: Select[Any]) -> list[Standing]:
    """Of each player's totals (see server.store.tally)."""
    return [
        Standing(
            place=place,
            name=row.name,
            battles=row.battles,
            wins=row.wins,
            hits=row.hits,
            seconds=row.seconds,
            shots=row.shots,
            given=row.given,
            kills=row.kills,
            accuracy=accuracy(row.met, row.aimed),
        )
        for place, row in enumerate(connection.execute(in_order(totals)).all(), 1)
    ]


def in_order(totals: Select[Any]) -> Select[Any]:
    """The best of these. In the words of the index, so that of the table of standings only they are read."""
    table = totals.subquery()
    hits_taken: ColumnElement[float] = literal_column(schema.HITS_TAKEN)
    return select(table).order_by(table.c.wins.desc(), hits_taken, table.c.name).limit(MAX_PLAYERS)


def _with_fighters(connection: Connection, rows: Sequence[Row[Any]], clocks: Clocks) -> list[Battle]:
    fighters: dict[int, list[Fighter]] = {row.id: [] for row in rows}
    ordered = (
        select(schema.fighters)
        .where(schema.fighters.c.battle.in_(fighters))
        .order_by(schema.fighters.c.place, schema.fighters.c.id)
    )
    for row in connection.execute(ordered):
        fighters[row.battle].append(
            Fighter(
                name=row.name,
                robot=row.robot,
                avatar=row.avatar,
                place=row.place,
                life=row.life,
                left=row.left,
                hits=row.hits,
                seconds=row.seconds,
                team=row.team,
                shots=row.shots,
                given=row.given,
                kills=row.kills,
            )
        )
    running = _running(connection, [row.id for row in rows if row.ended is None], clocks)
    return [
        Battle(
            id=row.id,
            number=row.number,
            began=row.began,
            ended=row.ended,
            cause=row.cause,
            counts=row.counts,
            so_far=running.get(row.id),
            arena=row.arena,
            fighters=tuple(fighters[row.id]),
        )
        for row in rows
    ]


def _events(connection: Connection, battle: int, kinds: Sequence[str]) -> Iterator[tuple[float, str, dict[str, Any]]]:
    """Of that battle, in their order: Unix time in s, kind, fields."""
    events = schema.events.c
    kept = select(events.at, events.kind, events.data).where(events.battle == battle, events.kind.in_(kinds))
    for row in connection.execute(kept.order_by(events.id)):
        yield row.at, row.kind, row.data


def _running(connection: Connection, battles: Sequence[int], clocks: Clocks) -> dict[int, float]:
    """Which of these battles are running (at most the newest of each arena), and for how long, in s."""
    if not battles:
        return {}
    battle, others, state = schema.battles.c, schema.battles.alias().c, schema.state.c
    # Walks back from the end of the table, where an arena's newest battle usually is; with NOT EXISTS, PostgreSQL reads
    # the whole table.
    newest = select(others.id).where(others.arena == battle.arena).order_by(others.id.desc()).limit(1)
    told = (state.data[name].label(name) for name in ("game", "battle", CLOCK))
    query = (
        select(battle.id, battle.number, battle.began, state.at, *told)
        .join(schema.state, state.arena == battle.arena)
        .where(battle.id.in_(battles), battle.id == newest.scalar_subquery())
    )
    found = {}
    for row in connection.execute(query):
        if (row.game, row.battle) == (Game.PLAYING, row.number):
            clock = clock_of(row.at, row.clock)
            found[row.id] = max(0.0, clock["battle"] + clocks.age(clock) - row.began)
    return found


def _files(url: URL) -> list[Path]:
    """Which change with SQLite's database: the file, and what it is about to get."""
    if url.get_backend_name() != "sqlite" or not url.database:
        return []
    return [Path(url.database), Path(f"{url.database}-wal")]


def _look(file: Path) -> tuple[int, int, int] | None:
    try:
        seen = file.stat()
    except OSError:
        return None
    return seen.st_ino, seen.st_size, seen.st_mtime_ns


def _reader(url: URL) -> Engine:
    """A file is opened for each query, read-only: it may be put aside, restored or not be there yet."""
    if url.get_backend_name() != "sqlite" or not url.database:
        return make_engine(url, kept=_READERS)
    file = URL.create("sqlite", database=Path(url.database).absolute().as_uri(), query={"mode": "ro", "uri": "true"})
    return create_engine(file, poolclass=NullPool, connect_args={"timeout": _BUSY})
