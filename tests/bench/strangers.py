"""What the worst of visitors cost a battle: `python3 -m tests.bench.strangers` prints a row for each crowd of them.

The real master, a database with a season's battles, three robots and their drivers in a battle that runs. The crowd
asks for results and the hall as fast as it is answered, logs in with impossible names, sends half requests, and
subscribes to everything, from loopback addresses of its own, directly or by the front. Meanwhile somebody looks at
pages.
"""

import argparse
import asyncio
import contextlib
import json
import os
import random
import signal
import statistics
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import psutil
import requests
from sqlalchemy import URL, insert

from laser_bot_battle.open_files import allow_files
from server.pages.audience import COOKIE
from server.store import schema
from server.store.database import Database, make_engine
from server.store.tally import tally_left_over
from server.web.operator_api import VOTE_LONGEST
from tests.bench.bench_rosbridge import cpu_seconds
from tests.bench.rosbridge_load import Remote
from tests.bench.scale import FILES, SETTLE, TOKEN, Loaded, Row, loaded_master, measure
from tests.support.bare import text_of
from tests.support.light_robots import InLoop
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import HOST

BATTLES = 5441
ROBOTS = 3
SECONDS = 60.0
AFTER = 10.0  # s after the crowd has gone, until its memory is asked for again
AGAIN = 0.2  # s, after a connection was ended
BETWEEN = 0.5  # s, in which one of an audience does nothing
PING, LOOK = 0.1, 0.25  # s between two probes
ANSWER_WITHIN = 10.0  # s; who waits for longer counts as waiting for so long

# what must hold meanwhile, in s
PINGS, COMMANDS, PAGES = 0.1, 0.02, 0.5


class Crowd(NamedTuple):
    addresses: int
    connections: int  # of each address
    by_front: bool = False
    is_audience: bool = False  # well-behaved: they look at the hall's page, cheer and vote

    def __str__(self) -> str:
        kind = ", front" if self.by_front else ", audience" if self.is_audience else ""
        return f"{self.addresses} x {self.connections}{kind}"


NOBODY = Crowd(0, 0)
CROWDS = (
    NOBODY,
    Crowd(1, 1000),
    Crowd(8, 100),
    Crowd(1, 1000, True),
    Crowd(8, 100, True),
    Crowd(200, 1, is_audience=True),
)


class Felt(NamedTuple):
    """What the others felt of a crowd: times in s."""

    pings: list[float]
    pages: list[float]
    row: Row
    answers: Counter[str]  # that the crowd got, by status
    seats: int  # of players who are still there


def fill(folder: Path) -> None:
    """A season's battles, of four fighters each."""
    (folder / "data").mkdir()
    url = URL.create("sqlite", database=str(folder / "data" / "laserbot.db"))
    database = Database(url)
    database.open()
    database.close()
    began, draw = time.time() - BATTLES * 400, random.Random(7)
    battles, fighters = [], []
    for battle in range(1, BATTLES + 1):
        start = began + battle * 400
        ends = {"ended": start + 200, "cause": "the time is up", "counts": True}
        battles.append({"id": battle, "number": battle, "began": start, "arena": "", **ends})
        for place in range(1, 5):
            fought = {"life": 40 - 10 * place, "left": False, "hits": 6 + place, "seconds": 200.0}
            told = {"team": 0, "shots": 50, "given": 10 - place, "kills": 0}
            name = f"fighter{draw.randrange(40)}"
            one = {"battle": battle, "name": name, "robot": place, "avatar": 0, "place": place, **fought, **told}
            fighters.append(one)
    with make_engine(url).begin() as connection:
        connection.execute(insert(schema.battles), battles)
        connection.execute(insert(schema.fighters), fighters)
        while tally_left_over(connection):  # or the game would be busy with that, and each step changes all pages
            pass


def asked(path: str, body: str = "") -> bytes:
    form = f"Content-Type: application/x-www-form-urlencoded\r\nContent-Length: {len(body)}\r\n" if body else ""
    method = "POST" if body else "GET"
    return f"{method} {path} HTTP/1.1\r\nHost: battle.local\r\nAccept-Encoding: gzip\r\n{form}\r\n{body}".encode()


def of_audience(number: int, vote: int) -> list[bytes]:
    """What a phone sends one after the other: the hall's page asks how things stand, and its owner cheers and votes."""
    cookie = f"Cookie: {COOKIE}={number:032x}\r\n"
    routes = (
        "GET /audience",
        "POST /audience/cheer?name=driver0",
        f"POST /audience/vote?number={vote}&choice={number % 2}",
    )
    head = "HTTP/1.1\r\nHost: battle.local\r\nContent-Length: 0\r\n"
    return [f"{route} {head}{cookie}\r\n".encode() for route in routes]


RESULTS, HALL, LOG_IN = asked("/results?size=500"), asked("/watch"), asked("/signUpUser", "data=no+name!")
HALF = LOG_IN[:-5]
UPGRADE = (
    b"GET %s HTTP/1.1\r\nHost: battle.local\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)
TOPICS = ("/game_status", "/rosout", "/rosout_agg", "/positions", *(f"/Robot{n}/command" for n in range(ROBOTS)))


async def answer(reader: asyncio.StreamReader) -> str:
    """The next one's status, once it has come whole."""
    head = await reader.readuntil(b"\r\n\r\n")
    length = next((int(line[15:]) for line in head.split(b"\r\n") if line.lower().startswith(b"content-length:")), 0)
    await reader.readexactly(length)
    return head[9:12].decode()


class Strangers(InLoop):
    """A crowd."""

    def __init__(self, web_port: int, bridge_port: int, bridge_path: str) -> None:
        allow_files(FILES)
        super().__init__()
        self._web, self._bridge, self._path = web_port, bridge_port, bridge_path.encode()
        self._answers: Counter[str] = Counter()

    def come(self, addresses: int, connections: int) -> None:
        self.do(self._come(addresses, connections))

    def watch(self, addresses: int, vote: int) -> None:
        """And take part in the vote of this number."""
        self.do(self._watch(addresses, vote))

    def answers(self) -> Counter[str]:
        return self._answers

    async def _come(self, addresses: int, connections: int) -> None:
        kinds = (
            [self._ask_for(RESULTS)] * 7 + [self._ask_for(HALL)] * 3 + [self._ask_for_all] + [self._ask_for(LOG_IN)] * 4
        )
        kinds += [self._send_half] * 3 + [self._subscribe] * 2
        for number in range(addresses * connections):
            address = f"127.66.{number % addresses}.1"
            self.keep(self._go_on(kinds[number // addresses % len(kinds)], address))

    async def _watch(self, addresses: int, vote: int) -> None:
        for number in range(addresses):
            self.keep(self._go_on(self._take_part(number, vote), f"127.66.{number}.1"))

    def _take_part(self, number: int, vote: int) -> Callable[..., object]:
        async def take_part(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            await asyncio.sleep(number / 100)
            while True:
                for text in of_audience(number, vote):
                    writer.write(text)
                    self._answers[await answer(reader)] += 1
                    await asyncio.sleep(BETWEEN)

        return take_part

    async def _go_on(self, kind: Callable[..., object], address: str) -> None:
        while True:
            port = self._bridge if kind == self._subscribe else self._web
            with contextlib.suppress(OSError, EOFError, asyncio.LimitOverrunError, ValueError):
                reader, writer = await asyncio.open_connection(HOST, port, local_addr=(address, 0))
                try:
                    await kind(reader, writer)  # type: ignore[misc]
                finally:
                    writer.close()
            await asyncio.sleep(AGAIN)

    def _ask_for(self, text: bytes) -> Callable[..., object]:
        async def ask(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            while True:
                writer.write(text)
                self._answers[await answer(reader)] += 1

        return ask

    async def _ask_for_all(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Never the same."""
        for number in range(1_000_000):
            writer.write(asked(f"/results.csv?size={300 + number % 200}&page={1 + number % 10}"))
            self._answers[await answer(reader)] += 1

    async def _send_half(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(HALF)
        await reader.read()

    async def _subscribe(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(UPGRADE % self._path)
        self._answers[await answer(reader)] += 1
        for topic in TOPICS:
            writer.write(text_of("subscribe", topic=topic))
        while await reader.read(1 << 16):
            pass


class Others(InLoop):
    """A robot's ping and a visitor, as they come, each time by a connection of its own."""

    def __init__(self, web_port: int, front_port: int) -> None:
        super().__init__()
        self._web, self._front = web_port, front_port
        self._took: dict[str, list[float]] = {"pings": [], "pages": []}
        self.do(self._begin())

    def took(self) -> dict[str, list[float]]:
        """What each has taken since the last time, in s."""
        taken, self._took = self._took, {"pings": [], "pages": []}
        return taken

    async def _begin(self) -> None:
        ping = asked("/incAlive", "ID=99")
        pages = [asked("/"), asked("/results"), asked("/results/leaderboard"), asked("/watch"), asked("/home")]
        self.keep(self._probe("pings", self._web, "127.77.0.1", [ping], PING))
        self.keep(self._probe("pages", self._front, "127.77.0.2", pages, LOOK))

    async def _probe(self, name: str, port: int, address: str, texts: list[bytes], pause: float) -> None:
        for number in range(1_000_000):
            began = time.monotonic()
            with contextlib.suppress(OSError, EOFError, TimeoutError):
                async with asyncio.timeout(ANSWER_WITHIN):
                    reader, writer = await asyncio.open_connection(HOST, port, local_addr=(address, 0))
                    writer.write(texts[number % len(texts)])
                    status = await answer(reader)
                    writer.close()
                    if status == "200":
                        self._took[name].append(time.monotonic() - began)
                        await asyncio.sleep(max(0.0, began + pause - time.monotonic()))
                        continue
            self._took[name].append(ANSWER_WITHIN)  # none is as bad as the latest


@contextlib.contextmanager
def front(loaded: Loaded, web_port: int) -> Iterator[tuple[int, int]]:
    """Its port and process."""
    port = free_port()
    settings = {
        "LASERBOT_BIND": HOST,
        "LASERBOT_HTTP_PORT": str(port),
        "LASERBOT_WEB_PORT": str(web_port),
        "LASERBOT_ROSBRIDGE_PORT": str(loaded.master.bridge_port),
    }
    program = Program.python("server.front", env={**os.environ, **settings})
    try:
        program.wait_for("the game is at", 30)
        yield port, program.process.pid
    finally:
        program.stop()


def open_vote(web: str) -> int:
    """Its number. It is open for longer than a crowd is there."""
    choices = [{"name": name, "own": False} for name in ("children", "beginners")]
    asked_for = {"choices": choices, "seconds": VOTE_LONGEST}
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    requests.post(f"{web}/operator/api/vote", json=asked_for, headers=bearer, timeout=10).raise_for_status()

    def number() -> int | None:
        vote = requests.get(f"{web}/audience", timeout=10).json()["vote"]
        return vote and int(vote["number"])

    until(lambda: number() is not None, 10, "the vote is open")
    found = number()
    assert found is not None
    return found


class Costs(NamedTuple):
    """Of one process of the master."""

    cpu: float  # cores, with the crowd there
    memory: tuple[float, float, float]  # MiB before the crowd, with it, and `AFTER` it


def feel(crowd: Crowd, seconds: float) -> tuple[Felt, dict[str, Costs]]:
    with loaded_master(ROBOTS, 0, fill) as loaded, contextlib.ExitStack() as stack:
        web_port = int(loaded.master.web.rpartition(":")[2])
        front_port, front_pid = stack.enter_context(front(loaded, web_port))
        if crowd.by_front:
            strangers = Remote(Strangers, front_port, front_port, "/rosbridge")
        else:
            strangers = Remote(Strangers, web_port, loaded.master.bridge_port, "/")
        stack.callback(strangers.close)
        others = Remote(Others, web_port, front_port if crowd.by_front else web_port)
        stack.callback(others.close)
        (child,) = psutil.Process(loaded.master.pids["server.main"]).children()
        pids = {**loaded.master.pids, "pages": child.pid, "front": front_pid}
        before = sizes(pids)
        if crowd.is_audience:
            strangers.call("watch", crowd.addresses, open_vote(loaded.master.web))
        else:
            strangers.call("come", crowd.addresses, crowd.connections)
        time.sleep(SETTLE)
        others.call("took")
        used, began = {name: cpu_seconds(pid) for name, pid in pids.items()}, time.monotonic()
        row = measure(loaded, ROBOTS, seconds)
        passed = time.monotonic() - began
        cores = {name: (cpu_seconds(pid) - used[name]) / passed for name, pid in pids.items()}
        meanwhile = sizes(pids)
        took, answers = others.call("took"), strangers.call("answers")
        seats = len(json.loads(loaded.pages.call("state")["users"]))
        strangers.close()
        time.sleep(AFTER)
        after = sizes(pids)
        costs = {name: Costs(cores[name], (before[name], meanwhile[name], after[name])) for name in pids}
        return Felt(took["pings"], took["pages"], row, answers, seats), costs


def sizes(pids: Mapping[str, int]) -> dict[str, float]:
    """MiB of memory."""
    return {name: psutil.Process(pid).memory_info().rss / 2**20 for name, pid in pids.items()}


def percentiles(times: list[float]) -> str:
    p50, p99 = statistics.median(times), statistics.quantiles(times, n=100)[98]
    return f"{p50 * 1e3:8.1f}{p99 * 1e3:8.1f}{max(times) * 1e3:8.0f}"


def told(memory: tuple[float, ...]) -> str:
    return ", ".join(f"{size:.0f}" for size in memory)


def main() -> None:
    parser = argparse.ArgumentParser(description="What the worst of visitors cost a battle.")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="for each crowd, 60 at most: players are hit")
    parser.add_argument("--crowds", type=int, nargs="+", default=range(len(CROWDS)), help="by their number, from 0")
    arguments = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    allow_files(FILES)
    print(f"{BATTLES} battles, {ROBOTS} robots and drivers, {arguments.seconds:g} s each; p50, p99, worst in ms")
    print("MiB of each program: before the crowd, with it, and after it")
    print(f"{'crowd':18}{'pings':>24}{'commands':>24}{'pages':>24}{'players':>9}", flush=True)
    for number in arguments.crowds:
        felt, costs = feel(CROWDS[number], arguments.seconds)
        commands = felt.row.figures.latencies
        print(
            f"{CROWDS[number]!s:18}{percentiles(felt.pings)}{percentiles(commands)}{percentiles(felt.pages)}{felt.seats:9}"
        )
        print(
            "    "
            + ", ".join(f"{name} {each.cpu:.2f} cores {told(each.memory)} MiB" for name, each in costs.items())
            + f"; lost {felt.row.figures.lost} of {felt.row.figures.sent}; "
            + ", ".join(f"{count} x {status}" for status, count in felt.answers.most_common()),
            flush=True,
        )


if __name__ == "__main__":
    main()
