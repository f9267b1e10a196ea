"""Bots at the real web server, by HTTP: how they come to a name and a robot without asking too often."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from flask import Flask, request
from werkzeug.serving import make_server

from server.bots.bot import Bot
from server.bots.bridge import Feed
from server.bots.web import Web
from tests.unit.server.test_api import Site


class BehindARouter(Web):
    """All from one address of the LAN, as the server believes its own proxy."""

    @property
    def cookies(self) -> dict[str, str]:
        return {**super().cookies, "X-Forwarded-For": "192.0.2.7"}


@contextmanager
def served(app: Flask) -> Iterator[int]:
    """The port at which it is."""
    server = make_server("127.0.0.1", 0, app, threaded=True)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_port
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def watched(site: Site) -> list[tuple[str, int]]:
    """Each sign-up and its answer's status, as they come."""
    seen: list[tuple[str, int]] = []

    @site.app.after_request
    def note(response):
        if request.path == "/signUpUser":
            seen.append((request.form["data"], response.status_code))
        return response

    return seen


async def sign_up(port: int, bots: int, seconds: float | None = None) -> list[str]:
    """The names of so many bots, for robots 0, 1 and so on, that start at once."""
    feed, names = Feed("ws://127.0.0.1:1"), asyncio.Lock()
    crew = [Bot(BehindARouter(f"http://127.0.0.1:{port}"), feed, robot, "easy", names) for robot in range(bots)]
    async with asyncio.timeout(seconds):
        await asyncio.gather(*(bot._sign_up() for bot in crew))
    return [bot._name for bot in crew]


def test_many_at_once_from_one_address_are_never_refused() -> None:
    site = Site(robots=7)
    seen = watched(site)
    with served(site.app) as port:
        names = asyncio.run(sign_up(port, 7))
    assert sorted(names) == [f"Bot{number}" for number in range(1, 8)]
    assert [status for _, status in seen] == [200] * 7, "none has tried twice"
    drivers = {player.robot: player.name for player in site.battle.snapshot().players}
    assert drivers == dict(enumerate(names))


def test_who_waits_for_a_robot_does_not_sign_up_meanwhile() -> None:
    site = Site(robots=1)
    seen = watched(site)
    site.battle.sign_up("Ann", "her session", 0)
    with served(site.app) as port, pytest.raises(TimeoutError):
        asyncio.run(sign_up(port, 1, 2.5))
    assert seen == []
