"""Several arenas on one database server: each has its own game, and what was played is everybody's."""

import gc
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager

import pytest
from sqlalchemy import URL, Connection, Engine, create_engine, event, select, text, update
from sqlalchemy.pool import NullPool

from server.game.persistence import restore
from server.game.referee import Referee
from server.store import schema
from server.store.database import Database, Kept
from server.store.forget import forget
from server.store.log import EventLog
from server.store.results import Count, Results
from server.web.settings import Settings
from tests.support.databases import rows
from tests.support.polling import until
from tests.support.postgres import Postgres, postgres
from tests.unit.server.conftest import Match

__all__ = ["postgres"]

# pg8000 leaves the closing of a broken connection to the interpreter, which may come to it in any later test
pytestmark = pytest.mark.filterwarnings("ignore:Exception ignored in. <socket:pytest.PytestUnraisableExceptionWarning")


@pytest.fixture(autouse=True, scope="module")
def nothing_left() -> Iterator[None]:
    """No test of another module meets what is left of this one's connections."""
    yield
    gc.collect()


class Arena:
    """Its match and its database, as a web server has them."""

    def __init__(self, url: URL, name: str) -> None:
        self._url, self._name = url, name
        self.match = Match(2)
        self.database, self.found = self._open()

    def restart(self) -> None:
        self.database.close()
        self.database, self.found = self._open()

    def write(self) -> None:
        """What the referee has decided since the last time."""
        referee = self.match.referee
        self.database.record(referee.take_journal(), referee.saved(self.match.now))
        until(lambda: not self.database._saved and not self.database.problem and self.database.waiting == 0, 20)

    def fight(self, winner: str, loser: str) -> None:
        self.match.start(winner, loser)
        self.match.hit(loser, 10)
        self.write()

    def _open(self) -> tuple[Database, Kept]:
        database = Database(self._url, self._name)
        return database, database.open()


@pytest.fixture
def url(postgres: Postgres) -> URL:
    return postgres.new_database()


@pytest.fixture
def arena(url: URL) -> Iterator[Callable[[str], Arena]]:
    arenas: list[Arena] = []

    def open_one(name: str) -> Arena:
        arenas.append(Arena(url, name))
        return arenas[-1]

    yield open_one
    for each in arenas:
        each.database.close()


@pytest.fixture
def results(url: URL) -> Iterator[Results]:
    with closing(Results(url)) as found:
        yield found


def test_each_arena_goes_on_with_its_own_battle_seats_and_robots(arena, results: Results) -> None:
    red, blue = arena("red"), arena("blue")
    assert (red.found, blue.found) == (Kept(), Kept())
    red.match.register("/only_in_red")
    red.match.start("ann", "bob")
    blue.match.start("cyd", "dan")
    for each in (red, blue):
        each.write()
    red.match.hit("ann", 3)
    blue.match.hit("dan", 10)
    for each in (red, blue):
        each.write()
    for each in (red, blue):
        each.restart()
        state = restore(each.found.state or {}, each.found.robots, each.match.now, 0.0)
        assert Referee(each.match.rules, state).snapshot(each.match.now) == each.match.state
    assert set(red.found.robots) - set(blue.found.robots) == {"/only_in_red"}
    assert (red.found.battles, blue.found.battles) == (1, 1)
    battles, _ = results.battles(1, 10)
    assert {(one.arena, one.running) for one in battles} == {("red", True), ("blue", False)}


def test_a_new_database_is_found_by_many_at_the_same_time(postgres: Postgres, caplog: pytest.LogCaptureFixture) -> None:
    """A festival's arenas start together."""
    count = 8
    url, together = postgres.new_database(), threading.Barrier(count)

    def start(number: int) -> str:
        database = Database(url, f"arena{number}")
        together.wait()
        with closing(database):
            database.open(patience=20)
            return database.problem

    with ThreadPoolExecutor(count) as threads:
        assert set(threads.map(start, range(count))) == {""}
    assert "duplicate" not in caplog.text


def test_the_leaderboard_is_of_all_arenas_and_the_log_of_one(arena, results: Results) -> None:
    red, blue = arena("red"), arena("blue")
    red.fight("ann", "bob")
    blue.fight("ann", "cyd")
    wanted = [("ann", 2, 2), ("bob", 0, 1), ("cyd", 0, 1)]
    for board in (results.standings(), results.leaderboard(0, 1e12)):
        assert [(one.name, one.wins, one.battles) for one in board] == wanted
    for each, own, others in ((red, "bob", "cyd"), (blue, "cyd", "bob")):
        log = EventLog(each.database)
        log.open()
        for told in (str(log.latest()), str(list(log.read()))):
            assert own in told
            assert others not in told


def test_an_arena_keeps_one_connection_however_many_look_at_it(arena, url: URL, results: Results) -> None:
    """PostgreSQL has a hundred, unless it is told otherwise."""
    for name in ("red", "blue"):
        arena(name).fight("ann", "bob")
    for _ in range(3):
        results.battles(1, 10)
        results.standings()
    count = text("SELECT count(*) FROM pg_stat_activity WHERE datname = :name AND pid <> pg_backend_pid()")

    def connections() -> int:
        engine = create_engine(url, poolclass=NullPool)
        with engine.connect() as connection:
            return int(connection.scalar(count, {"name": url.database}) or 0)

    until(lambda: connections() == 2, 20, "those that are not kept are gone")


def test_who_reads_again_and_again_logs_in_once(arena, url: URL, results: Results) -> None:
    """PostgreSQL's password costs longer than the leaderboard of a million battles."""
    arena("red").fight("ann", "bob")
    logins: list[object] = []
    event.listen(results._engine, "connect", lambda *connection: logins.append(connection))
    for _ in range(5):
        results.standings()
        results.battles(1, 10)
    assert len(logins) == 1


def test_a_page_of_battles_takes_as_many_statements_however_many_arenas_fight(arena, results: Results) -> None:
    """Each of them is a round trip to the server."""
    with counted(results._engine) as statements:
        for number in range(3):
            each = arena(f"arena{number}")
            each.match.start("ann", "bob")
            each.write()
            statements.clear()
            battles, _ = results.battles(1, 10)
            assert [one.running for one in battles] == [True] * (number + 1)
            assert len(statements) == 4, statements  # how many, which of them, who fought, what runs


def test_a_hit_is_written_by_three_statements(arena) -> None:
    """While the server waits for the next of them, it holds what the arena has locked."""
    red = arena("red")
    red.match.start("ann", "bob")
    red.write()
    with counted(red.database._engine) as statements:
        red.match.hit("bob")
        red.write()
    assert [statement.split()[0] for statement in statements] == ["UPDATE", "SELECT", "INSERT"], statements


@contextmanager
def counted(engine: Engine) -> Iterator[list[str]]:
    """The statements that are executed meanwhile."""
    statements: list[str] = []

    def note(_connection: Connection, _cursor: object, statement: str, *_: object) -> None:
        statements.append(statement)

    event.listen(engine, "before_cursor_execute", note)
    try:
        yield statements
    finally:
        event.remove(engine, "before_cursor_execute", note)


def test_battles_are_counted_as_they_come_and_all_of_them_each_minute(arena, url: URL) -> None:
    red = arena("red")
    red.fight("ann", "bob")
    with create_engine(url, poolclass=NullPool).begin() as connection:
        one = Count().now(connection, 0.0)
        late = "INSERT INTO battles (id, number, began, counts, arena, tallied) VALUES (:id, 0, 0, true, '', true)"
        for row, now, wanted in ((1000, 1.0, 2), (500, 2.0, 2), (1001, 3.0, 3), (1002, 61.0, 5)):
            connection.execute(text(late), {"id": row})
            one = one.now(connection, now)
            assert one.battles == wanted, f"after {now} s"


def test_no_arena_takes_anothers_events_for_its_own(arena, url: URL, monkeypatch) -> None:
    """A write breaks off, and another arena writes before it is tried again."""
    red, blue = arena("red"), arena("blue")
    transaction = red.database._transaction
    faults = [OSError("the connection is broken")]

    @contextmanager
    def broken_off() -> Iterator[Connection]:
        with transaction() as connection:
            yield connection
            if faults:
                blue.fight("cyd", "dan")
                raise faults.pop()

    red.match.start("ann", "bob")
    red.write()
    monkeypatch.setattr(red.database, "_transaction", broken_off)
    red.match.hit("bob", 10)
    red.write()
    kept = [kind for *_, kind, _, name in rows(url, "events") if name == "red"]
    assert (kept.count("BattleStarted"), kept.count("Hit"), kept.count("BattleEnded")) == (1, 10, 1)


def test_forgetting_waits_for_a_state_that_is_being_written(arena, url: URL) -> None:
    red = arena("red")
    red.fight("ann", "bob")
    red.match.sign_out("ann")
    red.write()
    engine = create_engine(url, poolclass=NullPool)
    locked = text("SELECT 1 FROM pg_stat_activity WHERE datname = :name AND wait_event_type = 'Lock'")

    def it_waits() -> bool:
        with engine.connect() as another:  # within one transaction the answer stays the same
            return bool(another.scalar(locked, {"name": url.database}))

    def forget_ann() -> None:
        with engine.begin() as connection:
            forget(connection, "ann")

    with engine.connect() as server, ThreadPoolExecutor() as together:
        (state,) = server.scalars(select(schema.state.c.data))
        server.execute(update(schema.state).values(data={**state, "newer": True}))
        forgetting = together.submit(forget_ann)
        try:
            until(it_waits)
        finally:
            server.commit()
        forgetting.result()
    [(_, _, data, _)] = rows(url, "state")
    assert data["newer"]
    assert "'ann'" not in str(data)


def test_a_player_is_forgotten_by_every_arenas_server(arena, url: URL) -> None:
    red, blue = arena("red"), arena("blue")
    for each, other in ((red, "bob"), (blue, "cyd")):
        each.fight("ann", other)
        each.match.sign_out("ann")
        each.write()
    engine = create_engine(url)
    with engine.begin() as connection:
        assert forget(connection, "ann") == "player 1"
    engine.dispose()
    red.match.sign_up("eve")
    red.match.ready("eve", "bob")  # the countdown takes the old result away
    red.write()
    blue.match.sign_up("fay")
    blue.write()
    assert "'ann'" not in str([row.data for row in rows(url, "state")]), "blue shows its result still"
    assert "player 1" in str([row.data for row in rows(url, "state")])
    blue.match.ready("fay", "cyd")
    blue.write()
    [(_, _, digest, arenas)] = rows(url, "forgotten")
    assert (digest, arenas) == (None, [])


def test_a_database_from_before_there_were_arenas_gets_them(arena, url: URL) -> None:
    first = arena("")
    first.fight("ann", "bob")
    first.database.close()
    engine = create_engine(url)
    with engine.begin() as connection:
        for table, column in (
            ("events", "arena"),
            ("battles", "arena"),
            ("state", "arena"),
            ("robots", "arena"),
            ("forgotten", "arenas"),
        ):
            connection.execute(text(f"ALTER TABLE {table} DROP COLUMN {column}"))
        connection.execute(text("ALTER TABLE robots ADD PRIMARY KEY (caller), ADD UNIQUE (robot)"))
    engine.dispose()
    first.restart()
    assert first.found.battles == 1
    assert len(first.found.robots) == 2
    red = arena("red")
    red.match.register("/id_service_client_0")
    red.fight("cyd", "dan")
    red.restart()
    assert red.found.robots == first.found.robots


def test_a_file_is_of_one_arena_whatever_its_name() -> None:
    environ = {"LASERBOT_ARENA": "red", "LASERBOT_DATABASE": "postgresql://u:secret@db/game"}
    assert Settings.from_env(environ).arena == "red"
    assert Settings.from_env({"LASERBOT_ARENA": "red"}).arena == ""
