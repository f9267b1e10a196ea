"""The wall's clock is set, by days, while a battle runs or its program starts again: durations stay what they were."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import URL, create_engine, select, update

from server.game.loop import GameLoop
from server.game.persistence import restore
from server.game.referee import Referee
from server.game.rules import Rules
from server.store import schema
from server.store.clocks import LONGEST, Clocks
from server.store.database import Database
from server.store.results import Results
from server.store.track import Floor, Piece
from server.web.settings import Settings
from tests.support.databases import rows
from tests.support.polling import until
from tests.support.site import whole_site
from tests.unit.server.conftest import Match

DAYS = 200 * 86_400.0
STEPS = pytest.mark.parametrize("step", [DAYS, -DAYS], ids=["ahead", "back"])


class Machine:
    """A master, whose web server keeps what the match decides."""

    def __init__(self, match: Match, file: Path) -> None:
        self.match = match
        self.url = URL.create("sqlite", database=str(file))
        self.wall = 1.74e9  # what the wall's clock is ahead of the monotonic one
        self.boot = "first"
        self.database = self._new()
        self.database.open()

    @property
    def clocks(self) -> Clocks:
        return Clocks(lambda: self.match.now + self.wall, lambda: self.match.now, self.boot)

    def write(self) -> None:
        referee = self.match.referee
        self.database.record(referee.take_journal(), referee.saved(self.match.now))

    def restart(self, pause: float) -> None:
        """Of the program, `pause` s later."""
        self.database.close()
        self.match.now += pause
        self._go_on()

    def start_again(self, pause: float) -> None:
        """Of the whole machine: its monotonic clock begins anew, at 50 s."""
        self.database.close()
        self.wall += self.match.now + pause - 50.0
        self.match.now, self.boot = 50.0, "second"
        self._go_on()

    def close(self) -> None:
        self.database.close()

    def battle(self) -> dict[str, Any]:
        """The only one, as everybody sees it."""
        self.database.close()
        settings = Settings.from_env({"LASERBOT_DATABASE": f"sqlite:///{self.url.database}"})
        browser = whole_site(GameLoop(Referee(Rules())), settings).test_client()
        board = json.loads(browser.get("/results/leaderboard.json").text)
        battle: dict[str, Any] = json.loads(browser.get("/results/1.json").text)
        played = {one["name"]: one["seconds"] for one in board["players"]}
        return battle | {"played": played, "page": browser.get("/results/1").text}

    def _new(self) -> Database:
        return Database(self.url, clocks=self.clocks)

    def _go_on(self) -> None:
        self.database = self._new()
        kept = self.database.open()
        now = self.match.now
        state = restore(kept.state or {}, kept.robots, now, now - kept.saved_at)
        self.match.referee = Referee(self.match.rules, state)


@pytest.fixture
def machine(match: Match, tmp_path: Path) -> Iterator[Machine]:
    made = Machine(match, tmp_path / "game.db")
    yield made
    made.close()


def expect_20_seconds(machine: Machine) -> None:
    """In a battle in which bob was hit after 5 s, and ada left after 20."""
    began = next(began for _, _, began, *_ in rows(machine.url, "battles"))
    assert began == pytest.approx(1.74e9 + 1015)
    shown = machine.battle()
    assert shown["seconds"] == pytest.approx(20)
    assert [(one["what"], one["at"]) for one in shown["timeline"]] == [
        ("hit", pytest.approx(5)),
        ("left", pytest.approx(20)),
    ]
    assert {one["name"]: one["seconds"] for one in shown["fighters"]} == {
        "ada": pytest.approx(20),
        "bob": pytest.approx(20),
    }
    assert shown["played"] == {"ada": pytest.approx(20), "bob": pytest.approx(20)}
    assert "H250.0V" in shown["page"], "in the chart, bob has lost life after a quarter of the battle"


def hit_after_5_seconds(match: Match) -> None:
    match.start("ada", "bob")
    match.wait(4.9)
    match.hit("bob")


@STEPS
def test_a_battle_lasts_as_long_as_it_does_whatever_the_wall_says(machine: Machine, match: Match, step: float):
    hit_after_5_seconds(match)
    machine.write()
    machine.wall += step
    machine.database.keep_piece(Piece(1, Floor(2.0, 1.0, ()), [match.now], {0: [None]}))
    match.wait(15)
    match.sign_out("ada")
    machine.write()
    machine.database.keep_piece(Piece(1, Floor(2.0, 1.0, ()), [match.now], {0: [None]}))
    machine.close()
    expect_20_seconds(machine)
    assert machine.battle()["track"]["times"] == [pytest.approx(5), pytest.approx(20)]
    machine.restart(1.0)
    match.sign_up("cy")
    machine.write()
    machine.close()
    [*_, last] = rows(machine.url, "events")
    assert last.at == pytest.approx(match.now + machine.wall), "between battles, it is as late as the wall says"


@STEPS
def test_the_time_that_is_left_outlives_a_restart_and_a_step(machine: Machine, match: Match, step: float):
    hit_after_5_seconds(match)
    left = match.state.time_left
    machine.write()
    machine.wall += step
    machine.restart(7.0)
    assert match.state.time_left == pytest.approx(left - 7)
    match.wait(8)
    match.sign_out("ada")
    machine.write()
    machine.close()
    expect_20_seconds(machine)


@pytest.mark.parametrize(
    ("step", "age"), [(0.0, 7.0), (DAYS, LONGEST), (-DAYS, 0.0)], ids=["as it is", "ahead", "back"]
)
def test_after_a_start_of_the_machine_the_wall_is_believed_within_reason(
    new_match: Callable[..., Match], tmp_path: Path, step: float, age: float
):
    match = new_match(rules=Rules(battle_limit=86_400))
    machine = Machine(match, tmp_path / "game.db")
    hit_after_5_seconds(match)
    left = match.state.time_left
    machine.write()
    machine.wall += step
    machine.start_again(7.0)
    assert match.state.time_left == pytest.approx(left - age)
    match.wait(8)
    match.sign_out("ada")
    machine.write()
    machine.close()
    assert machine.battle()["seconds"] == pytest.approx(5 + age + 8)


@STEPS
def test_a_battle_that_runs_is_as_long_as_it_has_run(machine: Machine, match: Match, step: float):
    hit_after_5_seconds(match)
    machine.write()
    until(lambda: machine.database.waiting == 0 and rows(machine.url, "battles"), 10)
    machine.wall += step
    match.now += 15
    battle, _ = Results(machine.url, machine.clocks).battle(1) or pytest.fail("there is none")
    assert battle.running
    assert battle.so_far == pytest.approx(20)


def test_the_state_of_an_older_program_is_as_old_as_the_wall_says(machine: Machine, match: Match):
    hit_after_5_seconds(match)
    left = match.state.time_left
    machine.write()
    machine.close()
    engine = create_engine(machine.url)
    with engine.begin() as connection:
        data = connection.scalars(select(schema.state.c.data)).one()
        del data["clock"]
        connection.execute(update(schema.state).values(data=data))
    engine.dispose()
    machine.restart(7.0)
    assert match.state.time_left == pytest.approx(left - 7)
    match.wait(8)
    match.sign_out("ada")
    machine.write()
    machine.close()
    expect_20_seconds(machine)


def test_programs_of_one_machine_agree_how_old_a_moment_is():
    mark = Clocks().mark() | {"unix": 0.0}
    assert 0 <= Clocks().age(mark) < 60
    assert Clocks(boot="another").age(mark) == LONGEST
    assert Clocks(boot="").age(mark | {"boot": ""}) == LONGEST, "nobody knows"
    ahead = mark | {"monotonic": mark["monotonic"] + 1e6}
    assert Clocks().age(ahead) == LONGEST, "a container's own clock"
