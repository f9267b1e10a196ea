"""What all bots share."""

import asyncio

from server.bots.bridge import Feed
from server.bots.game import Floor

FLOOR = Floor(1.0, 1.0, ((0.5, 0.0, 0.5, 0.6),))


def test_paths_are_planned_once_for_all_bots_and_anew_on_another_floor() -> None:
    async def plan() -> None:
        feed = Feed("ws://localhost")
        first, second = await asyncio.gather(feed.paths_on(FLOOR), feed.paths_on(Floor(1.0, 1.0, FLOOR.walls)))
        assert first is second
        assert (await feed.paths_on(Floor(2.0, 1.0, ()))).walls == ()

    asyncio.run(plan())
