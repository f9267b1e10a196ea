"""The table of who fought: what a battle's events come to, so that a leaderboard need not read them all."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import Connection, delete, insert, select

from server.store import schema
from server.store.course import KINDS, Course, courses


class Outcome(NamedTuple):
    """Of a battle: when it began, in Unix s, and once it has ended when that was, and its result."""

    began: float
    ended: float | None = None
    result: Sequence[Mapping[str, Any]] | None = None  # see server.game.snapshot.Placing


def read_courses(connection: Connection, battle: int) -> list[Course]:
    """How the battle in that row went for each fighter."""
    events = schema.events.c
    recorded = connection.execute(
        select(events.at, events.kind, events.data)
        .where(events.battle == battle, events.kind.in_(KINDS))
        .order_by(events.id)
    )
    return courses((row.at, row.kind, row.data) for row in recorded)


def keep_fighters(connection: Connection, battle: int, outcome: Outcome) -> None:
    """Write who fought in the battle in that row, as far as it has gone."""
    fighters = schema.fighters
    placings = {placing["name"]: placing for placing in outcome.result or ()}
    lasted = (outcome.ended or outcome.began) - outcome.began
    connection.execute(delete(fighters).where(fighters.c.battle == battle))
    rows = []
    for course in read_courses(connection, battle):
        placing = placings.get(course.name, {})
        rows.append(
            {
                "battle": battle,
                "name": course.name,
                "robot": course.robot,
                "avatar": course.avatar,
                "place": placing.get("place"),
                "life": placing.get("life", course.life),
                "left": placing.get("left", course.left is not None),
                "hits": course.hits,
                "team": course.team,
                "shots": placing.get("shots"),
                "given": course.given,
                "kills": course.kills,
                "seconds": course.fought(lasted),
            }
        )
    if rows:
        connection.execute(insert(fighters).values(rows))
