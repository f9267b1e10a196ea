"""Many viewers of one arena, and what its pages may do in a browser."""

import asyncio
import http.client
import json

import pytest
import requests
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus

from laser_bot_battle.openings import OF_ADDRESS
from laser_bot_battle.proxies import FORWARDED
from sim.arena.viewers import CROWD, MAX_VIEWERS
from tests.integration.sim.arena import HOST, Arena


async def come(arena: Arena, count: int) -> list[ClientConnection]:
    """So many viewers, in order, each of which has seen the arena; a proxy here says that they are from elsewhere."""
    viewers = []
    for number in range(count):
        who = {FORWARDED: f"10.0.{number // OF_ADDRESS}.1"}
        viewers.append(await connect(arena.view_url, compression=None, ping_interval=None, additional_headers=who))
        await viewers[-1].recv()
    return viewers


async def states(viewer: ClientConnection, seconds: float) -> int:
    count = 0
    try:
        async with asyncio.timeout(seconds):
            async for _ in viewer:
                count += 1
    except TimeoutError:
        return count
    raise AssertionError("the arena has closed the view")


async def leave(viewers: list[ClientConnection]) -> None:
    await asyncio.gather(*(viewer.close() for viewer in viewers))


@pytest.mark.slow  # the time is real
def test_in_a_crowd_who_drives_sees_more_than_who_watches(arena: Arena) -> None:
    async def scene() -> tuple[int, int, int]:
        viewers = await come(arena, CROWD + 10)
        watching, driving, late = viewers[0], viewers[1], viewers[-1]
        await watching.send("watch")
        rest = [asyncio.create_task(states(viewer, 5)) for viewer in viewers[2:-1]]
        await states(driving, 0.5)  # the word has arrived
        found = await asyncio.gather(*(states(viewer, 3) for viewer in (watching, driving, late)))
        await asyncio.gather(*rest)
        await leave(viewers)
        return found[0], found[1], found[2]

    watching, driving, late = asyncio.run(scene())
    assert watching < 0.65 * driving
    assert late < 0.65 * driving
    assert watching > 0.2 * driving


@pytest.mark.slow
def test_one_more_than_the_most_is_turned_away_and_room_is_made_by_leaving(arena: Arena) -> None:
    async def scene() -> None:
        viewers = await come(arena, MAX_VIEWERS)
        with pytest.raises(InvalidStatus, match="503"):
            await connect(arena.view_url)
        await leave(viewers[:1])
        async with asyncio.timeout(10):
            while True:
                try:
                    viewers += await come(arena, 1)
                    break
                except InvalidStatus:
                    await asyncio.sleep(0.05)
        await leave(viewers[1:])

    asyncio.run(scene())


def test_a_state_goes_uncompressed_or_each_viewer_would_cost_its_compression(arena: Arena) -> None:
    async def extensions() -> list[object]:
        async with connect(arena.view_url, compression="deflate") as viewer:
            assert json.loads(await viewer.recv())["type"] == "arena"
            return list(viewer.protocol.extensions)

    assert asyncio.run(extensions()) == []


@pytest.mark.parametrize("file", ["", "arena.js", "nothing.js"])
def test_every_answer_says_what_a_browser_may_do(arena: Arena, file: str) -> None:
    headers = requests.get(arena.files + file if file else arena.page, timeout=5).headers
    policy = headers["Content-Security-Policy"]
    assert "default-src 'self'" in policy
    assert f"frame-ancestors 'self' http://{HOST}:* https://{HOST}:*" in policy
    assert headers["X-Content-Type-Options"] == "nosniff"


def test_the_page_finds_rosbridge(arena: Arena) -> None:
    answer = requests.get(f"http://{HOST}:{arena.view_port}/", timeout=5)
    assert f'name="rosbridge-port" content="{arena.env["LASERBOT_ROSBRIDGE_PORT"]}"' in answer.text
    assert f"ws://{HOST}:{arena.env['LASERBOT_ROSBRIDGE_PORT']} " in answer.headers["Content-Security-Policy"]


@pytest.mark.parametrize(
    ("host", "status"), [("hall.local:8080", 200), ("[::1]:8080", 200), ("a;script-src *", 400), ("", 400), (None, 200)]
)
def test_a_host_that_is_none_is_refused(arena: Arena, host: str | None, status: int) -> None:
    connection = http.client.HTTPConnection(HOST, arena.view_port, timeout=5)
    connection.putrequest("GET", "/", skip_host=True)
    if host is not None:
        connection.putheader("Host", host)
    connection.endheaders()
    answer = connection.getresponse()
    assert answer.status == status
    answer.read()
    connection.close()
