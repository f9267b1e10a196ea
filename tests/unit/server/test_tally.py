"""The standings of all battles: the same as if all battles were read again, whoever wrote them, and when."""

import json
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import URL, Engine, create_engine, insert, text, update
from sqlalchemy.pool import NullPool

from server.store import schema, versions
from server.store.forget import forget
from server.store.results import Results, all_standings, in_order
from server.store.tally import tally, tally_left_over
from tests.support.databases import rows
from tests.support.postgres import Postgres, postgres

__all__ = ["postgres"]

EVER = (0.0, 1e12)


class Season:
    """A database to which battles come."""

    def __init__(self, url: URL) -> None:
        self.url = url
        self.engine: Engine = create_engine(url, poolclass=NullPool)
        self.results = Results(url)
        with self.engine.begin() as connection:
            versions.prepare(connection)
        self._battles = 0

    def fight(self, *names: str, ended: bool = True, counts: bool = True, given: int | None = 3) -> int:
        """Won by the first; written as a program does that knows no standings."""
        self._battles += 1
        values = {"number": self._battles, "began": 1.0, "ended": 2.0 if ended else None, "counts": counts}
        with self.engine.begin() as connection:
            connection.execute(insert(schema.battles).values(id=self._battles, **values))
            for place, name in enumerate(names, 1):
                fighter = {"name": name, "robot": place, "avatar": 0, "place": place, "life": 0, "hits": place}
                fighter |= {"seconds": 9.0, "shots": 10, "given": given, "kills": given and 1}
                connection.execute(insert(schema.fighters).values(battle=self._battles, **fighter))
        return self._battles

    def add(self, battle: int) -> None:
        with self.engine.begin() as connection:
            tally(connection, battle)

    @property
    def is_right(self) -> bool:
        """As the same of all days, read from the battles themselves."""
        return self.results.standings() == self.results.leaderboard(*EVER)

    @property
    def left_over(self) -> list[int]:
        return [row.id for row in rows(self.url, "battles") if not row.tallied]


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return Season(URL.create("sqlite", database=str(tmp_path / "season.db")))


def test_battles_are_added_up(season: Season):
    for names in (("ann", "bob"), ("bob", "ann", "cyd"), ("ann", "cyd")):
        season.add(season.fight(*names))
    assert season.left_over == []
    assert [(one.name, one.wins, one.battles, one.given) for one in season.results.standings()] == [
        ("ann", 2, 3, 9),
        ("bob", 1, 2, 6),
        ("cyd", 0, 2, 6),
    ]
    assert season.is_right


def test_a_server_that_adds_up_what_is_left_over_gives_whole_numbers(postgres: Postgres):
    season = Season(postgres.new_database())
    season.add(season.fight("ann", "bob"))
    season.fight("bob", "ann")
    with closing(season.results) as results:
        standings = results.standings()
    assert json.loads(json.dumps([(one.name, one.wins, one.hits, one.given) for one in standings])) == [
        ["ann", 1, 3, 6],
        ["bob", 1, 3, 6],
    ]


@pytest.mark.parametrize("kind", ["SQLite", "PostgreSQL"])
def test_the_leaderboard_reads_and_sorts_no_more_than_it_shows(kind: str, season: Season, postgres: Postgres):
    """Also where many have won as often."""
    if kind == "PostgreSQL":
        season = Season(postgres.new_database())
    totals = {"battles": 40, "wins": 10, "seconds": 1.0}
    players = [{"name": f"p{number}", "hits": number * 7919 % 97, **totals} for number in range(5000)]
    explain = "EXPLAIN" if kind == "PostgreSQL" else "EXPLAIN QUERY PLAN"
    query = in_order(all_standings()).compile(season.engine, compile_kwargs={"literal_binds": True})
    with season.engine.begin() as connection:
        connection.execute(insert(schema.standings), players)
        connection.execute(text("ANALYZE"))
        plan = "\n".join(str(row) for row in connection.execute(text(f"{explain} {query}")))
    assert "standings_order" in plan, plan
    assert not {"Sort", "B-TREE"} & set(plan.replace("'", " ").split()), plan


def test_a_battle_is_added_once(season: Season):
    battle = season.fight("ann", "bob")
    season.add(battle)
    season.add(battle)
    assert season.is_right


def test_what_is_not_known_of_a_battle_does_not_hide_the_others(season: Season):
    for given in (None, 3, None):
        season.add(season.fight("ann", "bob", given=given))
    assert season.results.standings()[0].given == 3
    assert season.results.standings()[0].accuracy == 0.3
    assert season.is_right


def test_neither_an_aborted_battle_counts_nor_one_that_runs(season: Season):
    for battle in (season.fight("ann", "bob", counts=False), season.fight("bob", "ann", ended=False)):
        season.add(battle)
    assert season.results.standings() == []
    assert season.left_over == [2], "it may still end"


def test_who_reads_adds_what_an_older_program_has_written(season: Season):
    season.add(season.fight("ann", "bob"))
    season.fight("bob", "ann")
    season.fight("bob", "cyd")
    assert season.left_over == [2, 3]
    assert [(one.name, one.wins) for one in season.results.standings()] == [("bob", 2), ("ann", 1), ("cyd", 0)]
    assert season.is_right


def test_what_is_left_over_is_added_a_part_at_a_time(season: Season):
    for _ in range(5):
        season.fight("ann", "bob")
    more = []
    for _ in range(3):
        with season.engine.begin() as connection:
            more.append(tally_left_over(connection, 2))
        assert season.is_right
    assert (more, season.left_over) == ([True, True, False], [])


def test_a_player_who_is_forgotten_has_another_name_there_too(season: Season):
    season.add(season.fight("ann", "bob"))
    with season.engine.begin() as connection:
        neutral = forget(connection, "ann")
    assert [one.name for one in season.results.standings()] == [neutral, "bob"]
    assert season.is_right


def test_battles_that_were_changed_by_hand_are_added_up_anew(season: Season):
    season.add(season.fight("ann", "bob"))
    with season.engine.begin() as connection:
        connection.execute(update(schema.battles).values(counts=False))
        connection.execute(text("DELETE FROM standings"))
        connection.execute(text("UPDATE battles SET tallied = false"))
    assert season.results.standings() == []
