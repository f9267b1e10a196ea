"""A referee with a clock that the test moves, and a web application over a real battle."""

from collections.abc import Callable, Iterator

import pytest

from server.game.referee import Referee, Rules, Verdict
from server.game.snapshot import Placing, Player, Snapshot


class Match:
    """Robots 0 to `robots`-1 registered at time 1000 s; sessions are named after the players."""

    def __init__(self, robots: int = 4, rules: Rules | None = None) -> None:
        self.referee = Referee(rules or Rules())
        self.now = 1000.0
        for number in range(robots):
            assert self.referee.add_robot(f"/id_service_client_{number}", self.now) == number

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
        robot = self.player(name).robot
        return [self.referee.hit(robot, self.now) for _ in range(times)]

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


@pytest.fixture
def new_match() -> Callable[..., Match]:
    return Match


@pytest.fixture
def match() -> Iterator[Match]:
    yield Match()
