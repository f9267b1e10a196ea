"""A tournament survives that its program is killed after any step: by a real database file, opened again."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from sqlalchemy import URL

from server.game import tournament_desk
from server.game.persistence import restore
from server.game.referee import Referee
from server.store.clocks import Clocks
from server.store.database import Database
from tests.support.polling import until

NAMES = ("ada", "bob", "cy", "dee")


def test_a_tournament_goes_on_after_a_kill_at_any_step(match, tmp_path: Path):
    url = URL.create("sqlite", database=str(tmp_path / "game.db"))
    clocks = Clocks(wall=lambda: match.now + 1e6, monotonic=lambda: match.now)

    def operate(wish, **wanted) -> Callable[[], None]:
        return lambda: match.referee.operate(partial(wish, by="Ann", **wanted), match.now)

    def fight(winner: str, loser: str) -> None:
        match.ready(winner, loser)
        match.wait(15)
        match.hit(loser, 10)

    steps = [
        lambda: match.sign_up(*NAMES),
        operate(tournament_desk.open_one, names=NAMES, best_of=3, patience=60),
        operate(tournament_desk.call),
        lambda: fight("ada", "dee"),
        lambda: fight("ada", "dee"),
        operate(tournament_desk.call),
        lambda: match.ready("cy"),
        lambda: match.wait(70),
        operate(tournament_desk.correct, number=2, winner="bob", reason="was there"),
        operate(tournament_desk.call),
        lambda: fight("bob", "ada"),
        lambda: fight("bob", "ada"),
        operate(tournament_desk.close),
    ]
    databases = [Database(url, clocks=clocks)]
    databases[0].open()
    for step in steps:
        step()
        databases[-1].record(match.referee.take_journal(), match.referee.saved(match.now))
        until(lambda: databases[-1].waiting == 0, 20, "all is written")
        before = match.referee.overview(match.now)["tournament"], match.state
        databases.append(Database(url, clocks=clocks))  # the killed one's is not closed
        kept = databases[-1].open()
        match.referee = Referee(match.rules, restore(kept.state or {}, kept.robots, match.now, 0.0))
        assert (match.referee.overview(match.now)["tournament"], match.state) == before
    for database in databases:
        database.close()
    tournament = match.referee.overview(match.now)["tournament"]
    assert [one["winner"] for one in tournament["matches"]] == ["ada", "bob", "bob"]
    assert [one["how"] for one in tournament["matches"]] == ["played", "corrected", "played"]
    assert tournament["champion"] == "bob"
