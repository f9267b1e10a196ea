"""A referee with a clock that the test moves, and a web application over a real battle."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest

from laser_bot_battle.floor import Zone
from server.game.persistence import restore
from server.game.referee import Referee, Verdict
from server.game.robot import HIT_INTERVAL
from server.game.rules import Rules
from server.game.snapshot import Placing, Player, Snapshot
from server.store import database


class Match:
    """Robots 0 to `robots`-1 registered at time 1000 s; sessions are named after the players. Unless a test is about
    the `protection` at the start of a battle, there is none."""

    def __init__(
        self, robots: int = 4, rules: Rules | None = None, protection: float = 0, zones: Sequence[Zone] = ()
    ) -> None:
        self.rules, self.zones = replace(rules or Rules(), protection=protection), zones
        self.referee = Referee(self.rules, zones=zones)
        self.now = 1000.0
        for number in range(robots):
            assert self.register(f"/id_service_client_{number}") == number

    def register(self, caller: str) -> int | None:
        """A robot comes, and is at once on its topics, as all others."""
        robot_id = self.referee.add_robot(caller, self.now)
        self.referee.robots_linked(self.state.robots, self.now)
        return robot_id

    def sign_up(self, *names: str) -> None:
        for name in names:
            verdict, player = self.referee.sign_up(name, self.session(name), 0, self.now)
            assert (verdict, player is None) == (Verdict.OK, False)

    def sign_out(self, name: str) -> Verdict:
        return self.referee.sign_out(name, self.session(name), self.now)

    def ready(self, *names: str, ready: bool = True) -> None:
        for name in names:
            assert self.referee.set_ready(name, ready, self.session(name), self.now) is Verdict.OK

    def start(self, *names: str) -> None:
        """Bring these players into a battle that begins now."""
        self.sign_up(*names)
        self.ready(*names)
        self.wait(15)
        assert self.state.game == 2

    def hit(self, name: str, times: int = 1) -> list[bool]:
        """As fast as the firmware reports hits."""
        robot = self.player(name).robot
        counted = []
        for _ in range(times):
            self.now += HIT_INTERVAL
            counted.append(self.referee.hit(robot, self.now))
        return counted

    def wait(self, seconds: float, dead_robots: tuple[int, ...] = (), gone_pages: tuple[str, ...] = ()) -> None:
        """Let time pass in steps of 0.4 s, with pings of all robots and pages but these."""
        end = self.now + seconds
        while self.now < end:
            self.now = min(self.now + 0.4, end)
            for robot in self.state.robots:
                if robot not in dead_robots:
                    self.referee.robot_alive(robot, self.now)
            for player in self.state.players:
                if player.name not in gone_pages:
                    self.referee.seen(player.session, self.now)

    def restart(self, pause: float = 0.0, saved: dict[str, Any] | None = None) -> None:
        """Go on in another program, `pause` s later, with what it finds `saved`; its clock begins at 50 s."""
        saved = json.loads(json.dumps(saved or self.referee.saved(self.now)))
        self.now = 50.0
        self.referee = Referee(self.rules, restore(saved, {}, self.now, pause), self.zones)

    @property
    def state(self) -> Snapshot:
        return self.referee.snapshot(self.now)

    def player(self, name: str) -> Player:
        return next(player for player in self.state.players if player.name == name)

    def placing(self, name: str) -> Placing:
        return next(placing for placing in self.state.result if placing.name == name)

    @property
    def names(self) -> list[str]:
        return [player.name for player in self.state.players]

    @property
    def ranking(self) -> list[tuple[int, str]]:
        return [(placing.place, placing.name) for placing in self.state.result]

    @staticmethod
    def session(name: str) -> str:
        return f"session of {name}"


@pytest.fixture(autouse=True)
def time_to_write(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests look at what a closed database has got. A program that ends waits for a second, whatever is left."""
    monkeypatch.setattr(database, "CLOSE_WITHIN", 10.0)


@pytest.fixture
def new_match() -> Callable[..., Match]:
    return Match


@pytest.fixture
def match() -> Iterator[Match]:
    yield Match()
