"""The table of who has won most: what all battles come to for each player, added up as each of them ends, so that the
leaderboard does not take longer with every season.

A battle that is not in it yet, because an older program wrote it, is added later; until then whoever reads the table
adds it up.
"""

from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, case, func, select, update
from sqlalchemy.dialects import postgresql, sqlite

from server.store import schema

AT_ONCE = 100  # older battles in a transaction, which keeps others from adding to the same players meanwhile

_standings = schema.standings.c
COUNTS = ("battles", "wins", "hits", "seconds")
SHOOTING = ("shots", "given", "kills", "met", "aimed")  # None: of no battle is it known


def sums() -> Select[Any]:
    """For each name: what its battles come to, of those that the caller chooses; `met` and `aimed` are hits and shots
    of the battles of which both are known."""
    fighters, battles = schema.fighters.c, schema.battles.c
    is_known = fighters.given.is_not(None) & fighters.shots.is_not(None)
    return (
        select(
            fighters.name,
            func.count().label("battles"),
            func.sum(case((fighters.place == 1, 1), else_=0)).label("wins"),
            func.sum(fighters.hits).label("hits"),
            func.sum(fighters.seconds).label("seconds"),
            func.sum(fighters.shots).label("shots"),
            func.sum(fighters.given).label("given"),
            func.sum(fighters.kills).label("kills"),
            func.sum(case((is_known, fighters.given))).label("met"),
            func.sum(case((is_known, fighters.shots))).label("aimed"),
        )
        .join(schema.battles, battles.id == fighters.battle)
        .where(battles.counts, battles.ended.is_not(None))
        .group_by(fighters.name)
    )


def is_left_over() -> ColumnElement[bool]:
    """Of a battle: it has ended, and is not in the table."""
    return schema.battles.c.ended.is_not(None) & ~schema.battles.c.tallied


def tally_left_over(connection: Connection, at_once: int = AT_ONCE) -> bool:
    """Add some of the battles that are not in the table. Whether there may be more."""
    battles = schema.battles.c
    chosen = select(battles.id).where(is_left_over()).order_by(battles.id).limit(at_once)
    found = connection.scalars(chosen.with_for_update(skip_locked=True)).all()  # another arena may be adding others
    if found:
        _tally(connection, battles.id.in_(found))
    return len(found) == at_once


def tally(connection: Connection, battle: int) -> None:
    """Add the battle in that row, which has just ended."""
    _tally(connection, (schema.battles.c.id == battle) & is_left_over())


def _tally(connection: Connection, chosen: ColumnElement[bool]) -> None:
    names = ("name", *COUNTS, *SHOOTING)
    # in the order of the names, or two arenas could wait for each other
    totals = sums().where(chosen).order_by(schema.fighters.c.name)
    dialect = postgresql if connection.dialect.name == "postgresql" else sqlite
    made = dialect.insert(schema.standings).from_select(names, totals)
    values: dict[str, Any] = {name: _standings[name] + made.excluded[name] for name in COUNTS}
    for name in SHOOTING:
        values[name] = func.coalesce(_standings[name] + made.excluded[name], _standings[name], made.excluded[name])
    connection.execute(made.on_conflict_do_update(index_elements=["name"], set_=values))
    connection.execute(update(schema.battles).where(chosen).values(tallied=True))
