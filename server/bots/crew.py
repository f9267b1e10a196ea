"""All bots of a master: the game server says which robots they drive, and how well."""

import asyncio
import logging
from typing import NoReturn

from laser_bot_battle.lifecycle import first_of
from laser_bot_battle.place import Place, find_again
from server.bots.bot import Bot
from server.bots.bridge import RETRY, Feed
from server.bots.settings import Settings
from server.bots.web import GameError, Web

ASK = 1.0  # s between two questions to the game server
GONE_AFTER = 5.0  # s without an answer of the server; it may be at another address then
LOOK = 0.1  # s

_log = logging.getLogger(__name__)


class Crew:
    """Starts and ends bots as the game server wants; what it has said last holds while it is away."""

    def __init__(self, settings: Settings, place: Place) -> None:
        """Needs a running event loop."""
        self._settings, self._place = settings, place
        self._web = Web(settings.web_url(place))
        self._feed = Feed(settings.rosbridge_url(place))
        self._following: asyncio.Task[None] | None = None  # the feed, while there are bots
        self._bots: dict[int, tuple[Bot, asyncio.Task[None]]] = {}  # by robot
        self._names = asyncio.Lock()
        self._told = ""

    async def run(self) -> Place:
        """Until cancelled, or until the arena has moved: returns where to. The robots are free then."""
        try:
            return await first_of(self._obey(), self._look_out())
        finally:
            await self._end(*self._bots)

    async def _obey(self) -> NoReturn:
        while True:
            try:
                given = await self._web.given(sees=not self._bots or not self._is_blind())
                self._tell(f"the game server at {self._settings.web_url(self._place)} is there")
                await self._follow(given)
            except GameError as error:
                self._tell(f"{error}; waiting")
            await asyncio.sleep(ASK)

    async def _follow(self, given: dict[int, str]) -> None:
        """Let bots drive these robots, at these levels, and no others."""
        over = [robot for robot, (_, task) in self._bots.items() if robot not in given or task.done()]
        await self._end(*over)
        if given:
            self._keep_following()
        for robot, level in given.items():
            if robot in self._bots:
                self._bots[robot][0].level = level
                continue
            bot = Bot(Web(self._settings.web_url(self._place)), self._feed, robot, level, self._names)
            self._bots[robot] = bot, asyncio.create_task(bot.run())
            _log.info("a bot is to drive robot %d (%s)", robot, level)

    def _keep_following(self) -> None:
        """Without the feed no bot sees anything: whatever has ended it, it begins again."""
        if self._following is None or self._following.done():
            if self._following is not None:
                _log.error("the feed from rosbridge has failed", exc_info=self._following.exception())
            self._following = asyncio.create_task(self._feed.follow())

    def _is_blind(self) -> bool:
        return self._feed.sight.is_blind(asyncio.get_running_loop().time())

    async def _end(self, *robots: int) -> None:
        tasks = [self._bots.pop(robot)[1] for robot in robots]
        if not self._bots and self._following is not None:
            tasks.append(self._following)
            self._following = None
        for task in tasks:
            task.cancel()
        for error in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(error, Exception):
                _log.error("a bot has failed", exc_info=error)

    async def _look_out(self) -> Place:
        """Where the arena is, once it has moved. A place that somebody has given is kept."""
        while True:
            await asyncio.sleep(RETRY)
            if self._place.arena and self._web.silence >= GONE_AFTER:
                _log.info("the server is gone: looking for arena %r at another address", self._place.arena)
                place = await self._look_while_gone()
                if place:
                    return place

    async def _look_while_gone(self) -> Place | None:
        search = asyncio.ensure_future(find_again(self._place.arena, self._place))
        try:
            while self._web.silence >= GONE_AFTER:
                if search.done():
                    return search.result()
                await asyncio.sleep(LOOK)
        finally:
            search.cancel()
            await asyncio.gather(search, return_exceptions=True)
        return None

    def _tell(self, text: str) -> None:
        """Log what has changed: the same text only once."""
        if text != self._told:
            _log.info("%s", text)
        self._told = text
