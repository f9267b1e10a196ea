"""The entrance asks arenas by real sockets: none of them can hold it up, and none is believed too much."""

import asyncio
import contextlib
import json
import threading
from collections.abc import Iterator

import pytest

from laser_bot_battle.arena_list import ListedArena
from laser_bot_battle.names import Game
from server.entrance import watcher
from server.entrance.lookups import Lookups
from server.entrance.seen import MAX_SIZE
from server.entrance.watcher import Watcher, ask
from tests.support.polling import until

STATE = json.dumps({"game": 0, "available_robots": 2, "users": [], "queue": [], "tournament": 0}).encode()
HEAD = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n\r\n"


async def ask_one(answer, within=5.0):
    """What becomes of a question to an arena that does `answer(writer)`."""
    asked = []

    async def serve(reader, writer):
        try:
            asked.append(await reader.readuntil(b"\r\n\r\n"))
            with contextlib.suppress(OSError):
                await answer(writer)
        finally:
            writer.transport.abort()  # what is not sent yet keeps no socket open

    async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        seen = await ask(f"http://127.0.0.1:{port}", Lookups(), within)
        return seen, asked[0], port


def sends(*pieces):
    async def answer(writer):
        for piece in pieces:
            writer.write(piece)
            await writer.drain()

    return answer


def test_an_arena_that_answers_is_heard():
    seen, asked, port = asyncio.run(ask_one(sends(HEAD, STATE[:10], STATE[10:])))
    assert (seen.game, seen.free) == (Game.STOPPED, 2)
    assert asked.startswith(b"GET /watch.json HTTP/1.0\r\n")
    assert f"Host: 127.0.0.1:{port}\r\n".encode() in asked


@pytest.mark.parametrize(
    "pieces",
    [
        (),
        (b"\r\n\r\n",),
        (b"SSH-2.0-OpenSSH\r\n",),
        (b"HTTP/1.1 302 Found\r\nLocation: http://evil.example/\r\n\r\n", STATE),
        (b"HTTP/1.1 503 Service Unavailable\r\n\r\n", STATE),
        (HEAD, STATE[:-3]),
        (HEAD, b"null"),
        (HEAD, b" " * (MAX_SIZE + 32 * 1024), STATE),
    ],
)
def test_what_is_no_answer_of_an_arena_is_none(pieces):
    with pytest.raises((ValueError, OSError)):
        asyncio.run(ask_one(sends(*pieces)))


def test_an_arena_that_drips_has_no_longer_than_one_that_is_silent():
    async def drip(writer):
        while True:
            writer.write(b" ")
            await writer.drain()
            await asyncio.sleep(0.01)

    async def say_nothing(writer):
        await asyncio.sleep(60)

    for answer in (drip, say_nothing):
        with pytest.raises(TimeoutError):
            asyncio.run(ask_one(answer, 0.2))


@pytest.fixture
def two() -> Iterator[tuple[str, str, threading.Event]]:
    """Where an arena says nothing, and where one answers, both until the event."""
    started, done = threading.Event(), threading.Event()
    origins: list[str] = []

    async def serve_both():
        over = asyncio.Event()

        async def stay(reader, writer):
            try:
                await over.wait()
            finally:
                writer.transport.abort()

        async def tell(reader, writer):
            await reader.readuntil(b"\r\n\r\n")
            writer.write(HEAD + STATE)
            await writer.drain()
            writer.transport.abort()

        servers = [await asyncio.start_server(serve, "127.0.0.1", 0, backlog=500) for serve in (stay, tell)]
        async with servers[0], servers[1]:
            origins.extend(f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}" for server in servers)
            started.set()
            await asyncio.to_thread(done.wait)
            over.set()

    serving = threading.Thread(target=lambda: asyncio.run(serve_both()))
    serving.start()
    assert started.wait(20)
    yield origins[0], origins[1], done
    done.set()
    serving.join()


@contextlib.contextmanager
def watched(over, *arenas):
    """The names of those that are heard, again and again; at the end it is over with all of them."""
    heard: list[str] = []
    asking = Watcher(arenas, lambda name, seen: heard.append(name))
    watching = threading.Thread(target=asking.run)
    watching.start()
    try:
        yield heard
    finally:
        asking.stop()
        over.set()
        watching.join()


def test_a_silent_arena_holds_up_no_other(two):
    """The second is heard while the question to the first still waits."""
    silent, well, over = two
    with watched(over, ListedArena("silent", ":1", silent), ListedArena("well", ":2", well)) as heard:
        until(lambda: heard, 20, "the other arena is heard")
    assert set(heard) == {"well"}


def test_neither_do_many_that_are_away(two, monkeypatch):
    """More than are asked at once, and no question to one of them ends before the test."""
    silent, well, over = two
    monkeypatch.setattr(watcher, "PERIOD", 0.02)
    monkeypatch.setattr(watcher, "WITHIN", 600.0)
    away = [ListedArena(f"away{number}", ":1", silent) for number in range(150)]
    with watched(over, ListedArena("well", ":2", well), *away) as heard:
        until(lambda: len(heard) >= 5, 20, "the arena that answers is asked again and again")


def test_a_name_server_that_is_silent_holds_up_no_other_arena_and_is_asked_once_at_a_time():
    answers = threading.Event()
    asked = []

    def look_up(host, port, **_):
        asked.append(host)
        if host == "silent.example":
            answers.wait()
        return [(None, None, None, None, ("192.0.2.1", port))]

    async def all_at_once():
        lookups = Lookups(look_up)
        for _ in range(3):
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(lookups.addresses("silent.example", 80), 0.05)
        assert await lookups.addresses("well.example", 80) == ["192.0.2.1"]
        assert asked == ["silent.example", "well.example"]
        answers.set()
        assert await lookups.addresses("silent.example", 80) == ["192.0.2.1"]

    asyncio.run(all_at_once())


def test_a_host_that_nobody_knows_is_an_arena_that_is_away():
    def look_up(host, port, **_):
        raise OSError("Name or service not known")

    with pytest.raises(OSError, match=r"nobody knows red\.example: Name or service not known"):
        asyncio.run(ask("http://red.example", Lookups(look_up)))


def test_the_next_address_of_a_host_is_tried_when_one_takes_nothing():
    async def both():
        served = []

        async def tell(reader, writer):
            served.append(await reader.readuntil(b"\r\n\r\n"))
            writer.write(HEAD + STATE)
            writer.transport.abort()

        async with await asyncio.start_server(tell, "127.0.0.2", 0) as server:
            port = server.sockets[0].getsockname()[1]
            places = [(None, None, None, None, (address, port)) for address in ("127.0.0.3", "127.0.0.2")]
            return await ask(f"http://red.example:{port}", Lookups(lambda *_, **__: places))

    assert asyncio.run(both()).free == 2
