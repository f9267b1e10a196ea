"""Bots at the real web server, by HTTP: they come and go as it says."""

import asyncio
import itertools
from collections.abc import Awaitable, Callable

import pytest

from laser_bot_battle.place import Place
from server.bots.bridge import Feed
from server.bots.crew import Crew
from server.bots.settings import Settings as BotSettings
from server.bots.web import GameError, Web
from server.game import desk
from server.web.bots import BotsProgram, create_bots
from server.web.settings import Settings
from tests.support.site import whole_site
from tests.unit.bots.test_sign_up import served
from tests.unit.server.test_api import Site


class Hall(Site):
    """A site that has robots for bots, and time that passes."""

    def __init__(self) -> None:
        super().__init__(robots=3)
        self.program = BotsProgram(lambda: self.now)
        self.app = whole_site(self.battle, Settings.from_env({}), create_bots(self.battle, self.program))

    def give(self, robot: int, level: str | None) -> None:
        self.battle.operate(lambda state, rules: desk.give_to_bot(state, rules, "Ann", robot, level))

    def drivers(self) -> dict[int, str]:
        return {player.robot: player.name for player in self.battle.snapshot().players}


async def becomes(wanted: Callable[[], bool]) -> None:
    async with asyncio.timeout(10):
        while not wanted():
            await asyncio.sleep(0.02)


def play(hall: Hall, story: Callable[[], Awaitable[None]]) -> None:
    """The story is told while the bots' program runs; it ends like one that got a signal."""

    async def run() -> None:
        place = Place("127.0.0.1", port, "http://127.0.0.1:1")
        crew = asyncio.create_task(Crew(BotSettings.read({}, rosbridge="127.0.0.1:1"), place).run())
        await story()
        crew.cancel()
        await asyncio.gather(crew, return_exceptions=True)

    with served(hall.app) as port:
        asyncio.run(run())


def test_a_robot_that_is_given_has_a_bot_until_it_is_taken_back() -> None:
    hall = Hall()

    async def story() -> None:
        await becomes(lambda: hall.program.state() == "ready")
        assert hall.drivers() == {}
        hall.give(2, "hard")
        await becomes(lambda: hall.drivers() == {2: "Bot1"})
        hall.give(0, "easy")
        await becomes(lambda: hall.drivers() == {2: "Bot1", 0: "Bot2"})
        hall.give(2, None)
        assert hall.drivers() == {0: "Bot2"}, "at once, not when the bot hears of it"
        hall.give(1, "easy")
        await becomes(lambda: hall.drivers() == {0: "Bot2", 1: "Bot1"})

    play(hall, story)
    assert hall.drivers() == {}, "the program has ended, and its bots with it"


def test_a_bot_whose_robot_somebody_needed_comes_back_for_it() -> None:
    hall = Hall()

    async def story() -> None:
        hall.give(1, "easy")
        await becomes(lambda: hall.drivers() == {1: "Bot1"})
        hall.battle.operate(lambda state, rules: desk.sign_out(state, rules, "Ann", "Bot1"))
        hall.battle.sign_up("Cid", "his session", 0, wanted=1)
        await asyncio.sleep(0)
        assert hall.drivers() == {1: "Cid"}
        hall.battle.sign_out("Cid", "his session")
        await becomes(lambda: hall.drivers() == {1: "Bot1"})

    play(hall, story)


def test_a_feed_that_fails_begins_again(monkeypatch: pytest.MonkeyPatch) -> None:
    hall, times = Hall(), itertools.count(1)
    following = asyncio.Event()

    async def follow(feed: Feed) -> None:
        if next(times) == 1:
            raise RuntimeError("something that nobody has thought of")
        following.set()
        await asyncio.Event().wait()

    monkeypatch.setattr(Feed, "follow", follow)

    async def story() -> None:
        hall.give(1, "easy")
        await becomes(following.is_set)

    play(hall, story)


def test_a_server_that_knows_no_bots_is_told_of() -> None:
    async def ask(port: int) -> dict[int, str]:
        return await Web(f"http://127.0.0.1:{port}").given(sees=True)

    with (
        served(Site().app) as port,
        pytest.raises(GameError, match=r"^bots: the answer of .* is not a JSON object$"),
    ):
        asyncio.run(ask(port))
