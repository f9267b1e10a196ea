"""What one database and one entrance carry: `python3 -m tests.bench.arenas` prints a table.

One PostgreSQL with a million battles, and the event writers of 50 masters (server.store.database, each with a battle in
which a hit falls every half second), while the leaderboard and pages of battles are read as the entrance does. Then the
entrance with 50 arenas that answer, and 5,000 visitors: each looks at the page and asks for the arenas every 5 s, and
one in ten presses Play at last. All of it on this machine, its own load included.
"""

import argparse
import asyncio
import itertools
import json
import math
import multiprocessing
import os
import statistics
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from typing import NamedTuple

from sqlalchemy import URL, create_engine, text
from sqlalchemy.pool import NullPool

from laser_bot_battle.open_files import allow_files
from server.game import events
from server.game.events import Event, Recorded
from server.game.snapshot import Placing
from server.store import versions
from server.store.database import Database
from server.store.results import Results
from tests.bench.bench_rosbridge import cpu_seconds
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.postgres import running_postgres
from tests.support.programs import Program
from tests.support.ros import HOST

ARENAS, BATTLES, NAMES, VISITORS = 50, 1_000_000, 100_000, 5_000
FIGHTERS = 4  # of a battle
HIT_EVERY = 0.5  # s, in each arena
HITS = 40  # of a battle
POLL = 5.0  # s between two questions of a page
SECONDS = 30.0
RAMP = 20.0  # s in which the visitors come
FILES = 12_000
PATIENCE = 120.0  # s, until all writers have logged in
STATE = json.dumps({"game": 0, "available_robots": 4, "users": [], "queue": [], "tournament": 0}).encode()

# what must hold, in s
WRITE_P99, LEADERBOARD = 0.05, 0.1


class Row(NamedTuple):
    """A line of the table."""

    what: str
    times: Sequence[float]  # s
    goal: float | None = None

    def __str__(self) -> str:
        if not self.times:
            return f"{self.what:44} none"
        ordered = sorted(self.times)
        p50, p99 = statistics.median(ordered), ordered[min(len(ordered) - 1, len(ordered) * 99 // 100)]
        goal = "" if self.goal is None else f"  goal {self.goal * 1e3:.0f} ms{'' if p99 <= self.goal else ': MISSED'}"
        return f"{self.what:44} {len(ordered):7}  p50 {p50 * 1e3:7.1f}  p99 {p99 * 1e3:7.1f} ms{goal}"


# one database

FORKED = multiprocessing.get_context("fork")
READY = FORKED.Semaphore(0)  # released by each writer that has logged in and played a first battle
BEGIN = FORKED.Event()  # for all writers: what a program does but once is not measured


def fill(url: URL, battles: int, names: int, arenas: int) -> None:
    """A past of that many battles, in the arenas' turns; added up as the programs do, a part at a time."""
    engine = create_engine(url, poolclass=NullPool)
    with engine.begin() as connection:
        versions.prepare(connection)
    step = 50_000
    for first in range(0, battles, step):
        last = min(first + step, battles) - 1
        with engine.begin() as connection:
            connection.execute(
                text(
                    "INSERT INTO battles (number, began, ended, cause, counts, arena, tallied) SELECT n, n * 60.0,"
                    f" n * 60.0 + 300, 'the time limit is reached', true, 'arena' || mod(n, {arenas}), true"
                    f" FROM generate_series({first}, {last}) AS n"
                )
            )
            connection.execute(
                text(
                    'INSERT INTO fighters (battle, name, robot, avatar, place, life, "left", hits, seconds, team,'
                    " shots, given, kills)"
                    f" SELECT b.id, 'p' || mod(b.number::bigint * 7919 + f * 104729, {names}), f, 0, f, 0, false, f,"
                    f" 300, 0, 40, 9, 1 FROM battles b, generate_series(1, {FIGHTERS}) AS f"
                    f" WHERE b.number BETWEEN {first} AND {last}"
                )
            )
    with engine.begin() as connection:
        connection.execute(
            text(
                "INSERT INTO standings (name, battles, wins, hits, seconds, shots, given, kills, met, aimed)"
                " SELECT name, count(*), sum((place = 1)::int), sum(hits), sum(seconds), sum(shots), sum(given),"
                " sum(kills), sum(given), sum(shots) FROM fighters GROUP BY name"
            )
        )
    with engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("VACUUM ANALYZE"))
    engine.dispose()


def write(url: URL, number: int, seconds: float) -> list[float]:
    """A master's database thread, in which battles are fought without an end. Returns the times from an event to its
    commit, in s."""
    database = Database(url, f"arena{number}")
    database.open()
    # nobody plays in two arenas at the same time
    names = [f"p{number * FIGHTERS + place}" for place in range(FIGHTERS)]
    starters = tuple(events.Fighter(name, robot, 0) for robot, name in enumerate(names))
    placings = tuple(Placing(name, robot, 100, 0, robot + 1, False) for robot, name in enumerate(names))
    times: list[float] = []

    def decide(battle: int, event: Event) -> None:
        began = time.monotonic()
        database.record([Recorded(began, event)], {"game": 2, "battle": battle, "users": []})
        while database.waiting:
            time.sleep(0.001)
        times.append(time.monotonic() - began)

    def fight(battle: int, hits: int, end: float) -> None:
        decide(battle, events.BattleStarted(battle, 300.0, starters))
        for hit in range(hits):
            time.sleep(HIT_EVERY)
            if time.monotonic() > end:
                return
            decide(battle, events.Hit(names[hit % FIGHTERS], hit % FIGHTERS, 100 - hit))
        decide(battle, events.BattleEnded(battle, "the time limit is reached", placings))

    fight(0, 1, math.inf)
    times.clear()
    READY.release()
    BEGIN.wait()
    end = time.monotonic() + seconds
    time.sleep(HITS * HIT_EVERY * number / ARENAS)  # the arenas' battles do not begin and end at the same moment
    for battle in itertools.count(1):
        if time.monotonic() > end:
            break
        fight(battle, HITS, end)
    assert not database.problem, database.problem
    database.close()
    return times


def read_again_and_again(read: Callable[[], object], pause: float, over: threading.Event) -> list[float]:
    times = []
    while not over.wait(pause):
        began = time.perf_counter()
        read()
        times.append(time.perf_counter() - began)
    return times


def bench_database(arenas: int, battles: int, names: int, seconds: float) -> Iterator[Row]:
    with running_postgres("fsync=on") as server:
        url = server.new_database()
        began = time.monotonic()
        fill(url, battles, names, arenas)
        print(f"({battles:,} battles of {names:,} players written in {time.monotonic() - began:.0f} s)", flush=True)
        results, over = Results(url), threading.Event()
        readers = {
            "leaderboard": (results.standings, 0.5, LEADERBOARD),
            "page of battles": (lambda: results.battles(1, 25), 1.0, None),
        }
        found: dict[str, list[float]] = {}

        def look(name: str) -> None:
            read, pause, _ = readers[name]
            found[name] = read_again_and_again(read, pause, over)

        threads = [threading.Thread(target=look, args=[name]) for name in readers]
        # a process each, as masters are; forked before there are threads
        with ProcessPoolExecutor(arenas, FORKED) as masters:
            writing = [masters.submit(write, url, number, seconds) for number in range(arenas)]
            for _ in writing:
                assert READY.acquire(timeout=PATIENCE), "a master does not come to its database"
            results.standings()  # logs in
            BEGIN.set()
            for thread in threads:
                thread.start()
            try:
                times = [time for writer in writing for time in writer.result()]
            finally:
                over.set()
                for thread in threads:
                    thread.join()
        yield Row(f"an event of one of {arenas} masters, to its commit", times, WRITE_P99)
        for name, (_, _, goal) in readers.items():
            yield Row(f"{name}, beside them", found[name], goal)


# one entrance


@contextmanager
def answering_arenas(count: int) -> Iterator[list[int]]:
    """Their ports; they answer in a thread."""
    ports: list[int] = []
    ready, over = threading.Event(), threading.Event()

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        writer.write(b"HTTP/1.0 200 OK\r\n\r\n" + STATE)
        writer.close()

    async def serve() -> None:
        servers = [await asyncio.start_server(answer, HOST, 0) for _ in range(count)]
        ports.extend(server.sockets[0].getsockname()[1] for server in servers)
        ready.set()
        await asyncio.to_thread(over.wait)

    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    ready.wait()
    try:
        yield ports
    finally:
        over.set()
        thread.join()


class Visitors:
    """Each with a loopback address of its own, without a connection that is kept: 5,000 people are not one browser."""

    def __init__(self, port: int) -> None:
        self._port = port
        self.times: dict[str, list[float]] = {"page": [], "arenas": [], "play": []}
        self.failed: Counter[str] = Counter()  # by what came instead of an answer

    async def visit(self, number: int, end: float) -> None:
        source = f"127.{1 + number // 62_500}.{number // 250 % 250}.{1 + number % 250}"
        await asyncio.sleep(RAMP * number / VISITORS)
        await self._ask("page", source, "GET / HTTP/1.0")
        while time.monotonic() < end:
            await self._ask("arenas", source, "GET /arenas.json HTTP/1.0")
            await asyncio.sleep(POLL)
        if number % 10 == 0:
            await self._ask("play", source, "POST /play HTTP/1.0", f"name=v{number}&avatar=0")

    async def _ask(self, what: str, source: str, request: str, form: str = "") -> None:
        began = time.monotonic()
        try:
            async with asyncio.timeout(10):
                reader, writer = await asyncio.open_connection(HOST, self._port, local_addr=(source, 0))
                head = f"{request}\r\nHost: {HOST}:{self._port}\r\nAccept-Encoding: gzip\r\n"
                if form:
                    head += f"Content-Type: application/x-www-form-urlencoded\r\nContent-Length: {len(form)}\r\n"
                writer.write(f"{head}\r\n{form}".encode())
                answer = await reader.read(-1)
                writer.close()
        except (OSError, TimeoutError) as error:
            self.failed[type(error).__name__] += 1
            return
        if b" 200 " not in answer[:16]:
            self.failed[answer.partition(b"\r\n")[0].decode()] += 1
            return
        self.times[what].append(time.monotonic() - began)


def bench_entrance(arenas: int, visitors: int, seconds: float) -> Iterator[Row]:
    allow_files(FILES)
    port = free_port()
    with answering_arenas(arenas) as ports, tempfile.TemporaryDirectory() as folder:
        program = Program.python(
            "server.entrance",
            env={
                "LASERBOT_BIND": HOST,
                "LASERBOT_ENTRANCE_PORT": str(port),
                "LASERBOT_ARENAS": " ".join(f"arena{n}=:{port}" for n, port in enumerate(ports)),
                "LASERBOT_DOMAIN": "*",
                "LASERBOT_DATA": folder,
            },
        )
        try:
            program.wait_for(f"the entrance to {arenas} arenas is at")
            crowd = Visitors(port)

            async def come() -> None:
                end = time.monotonic() + RAMP + seconds
                await asyncio.gather(*(crowd.visit(number, end) for number in range(visitors)))

            before, began = cpu_seconds(program.process.pid), time.monotonic()
            asyncio.run(come())
            cores = (cpu_seconds(program.process.pid) - before) / (time.monotonic() - began)
        finally:
            until(lambda: program.stop() == 0, 20, program.output)
    for what, times in crowd.times.items():
        yield Row(f"{visitors} visitors, {what}", times)
    print(f"(the entrance took {cores:.2f} cores; failed: {dict(crowd.failed) or 'none'})", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser("tests.bench.arenas", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--arenas", type=int, default=ARENAS)
    parser.add_argument("--battles", type=int, default=BATTLES)
    parser.add_argument("--visitors", type=int, default=VISITORS)
    parser.add_argument("--seconds", type=float, default=SECONDS)
    given = parser.parse_args()
    names = max(10, min(NAMES, given.battles // 10))
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} before", flush=True)
    for row in bench_database(given.arenas, given.battles, names, given.seconds):
        print(row, flush=True)
    for row in bench_entrance(given.arenas, given.visitors, given.seconds):
        print(row, flush=True)


if __name__ == "__main__":
    main()
