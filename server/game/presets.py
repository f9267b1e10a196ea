"""Sets of rules for an evening: those that there are everywhere, and what operators keep of their own."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from server.game.people import Words
from server.game.rules import DECLARED


@dataclass(frozen=True, slots=True)
class Preset:
    """It changes only the rules that it names; None: as configured."""

    name: Words
    rules: Mapping[str, Any]


def _built_in(name: str, **rules: Any) -> Preset:
    """What one of them, or an operator's own, changes, all the others set back: so they can follow each other. What the
    robots and the hall can do, such as their light, is not for them to say."""
    changed = (
        *("hit_damage", "countdown", "battle_limit", "friendly_fire"),
        *("handicap", "protection", "late_join", "teams", "hill", "pickups"),
        *("battles_in_row", "seat_minutes", "idle", "offer", "practice", "practice_beside", "hide_cameras"),
    )
    return Preset(name, {**dict.fromkeys(changed), **rules})


BUILT_IN = (
    _built_in(
        "children",
        hit_damage=5,
        countdown=20,
        battle_limit=180,
        friendly_fire=False,
        battles_in_row=2,
        idle=120,
        offer=40,
        practice=True,
    ),
    _built_in("beginners", hit_damage=5, countdown=20, battle_limit=240, practice=True),
    _built_in(
        "tournament",
        battle_limit=300,
        friendly_fire=True,
        battles_in_row=0,
        practice=False,
        hide_cameras=True,
    ),
    _built_in(
        "short_rounds",
        hit_damage=20,
        countdown=10,
        battle_limit=120,
        battles_in_row=1,
        idle=30,
        offer=15,
    ),
)


def of_now(name: str, chosen: Mapping[str, Any]) -> Preset:
    """All rules as they are, of which operators have `chosen` these."""
    return Preset(name, {rule: chosen.get(rule) for rule in DECLARED})
