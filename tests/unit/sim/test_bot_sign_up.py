"""Bots at the real web server, by HTTP: how they come to a name and a robot without asking too often."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import aiohttp
import pytest
from flask import Flask, request
from werkzeug.serving import make_server

from sim.bot import Bot
from sim.bot_settings import Settings
from tests.unit.server.test_api import Site

# all from one address of the LAN, as the server believes its own proxy
BEHIND_A_ROUTER = {"X-Forwarded-For": "192.0.2.7"}


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


async def sign_up(port: int, bots: int, seconds: float | None = None) -> list[int]:
    """The robots of so many bots that start at once."""
    settings = Settings.read({"LASERBOT_MASTER": "127.0.0.1", "LASERBOT_WEB_PORT": str(port)})
    place = settings.place
    assert place

    async def one() -> int:
        jar = aiohttp.CookieJar(unsafe=True)
        async with aiohttp.ClientSession(cookie_jar=jar, headers=BEHIND_A_ROUTER) as http:
            return await Bot(http, settings, place)._sign_up()

    async with asyncio.timeout(seconds):
        return await asyncio.gather(*(one() for _ in range(bots)))


def test_many_at_once_from_one_address_are_never_refused() -> None:
    site = Site(robots=7)
    seen = watched(site)
    with served(site.app) as port:
        robots = asyncio.run(sign_up(port, 7))
    assert sorted(robots) == [*range(7)]
    assert {status for _, status in seen} == {200}


def test_who_waits_for_a_robot_does_not_sign_up_meanwhile() -> None:
    site = Site(robots=0)
    seen = watched(site)
    with served(site.app) as port, pytest.raises(TimeoutError):
        asyncio.run(sign_up(port, 1, 2.5))
    assert seen == []
