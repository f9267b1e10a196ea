"""What the database says of an evening: each result must be what its events lead to, and nothing is left over."""

from collections import defaultdict
from dataclasses import asdict

from sqlalchemy import URL

from server.game.events import Recorded, from_json
from server.game.replay import replay
from tests.support.databases import rows


def battles(url: URL) -> int:
    """How many have ended."""
    return sum(battle.ended is not None for battle in rows(url, "battles"))


def wrong_results(url: URL) -> list[str]:
    """The battles whose result is not what their events lead to."""
    events: dict[int, list[Recorded]] = defaultdict(list)
    for event in rows(url, "events"):
        events[event.battle].append(Recorded(event.at, from_json(event.kind, event.data)))
    return [
        f"battle {battle.number}: its events lead to another result"
        for battle in rows(url, "battles")
        if battle.ended is not None and [asdict(placing) for placing in replay(events[battle.id])] != battle.result
    ]


def left_over(url: URL) -> list[str]:
    """Rows that nothing needs, in words."""
    known = {battle.id for battle in rows(url, "battles")}
    found = {
        "battles without an end": sum(battle.ended is None for battle in rows(url, "battles")),
        "fighters without a place": sum(fighter.place is None for fighter in rows(url, "fighters")),
        **{
            f"{table} of no battle": sum(row.battle not in {None, *known} for row in rows(url, table))
            for table in ("fighters", "tracks", "events")
        },
    }
    return [f"{count} {what}" for what, count in found.items() if count]
