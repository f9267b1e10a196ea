"""What was on the floor of a battle, for its replay, from its events: hills and pick-ups. Pure."""

from collections.abc import Iterable, Mapping
from typing import Any

from server.game.snapshot import PLACES

# the events that matter here, by server.game.events
KINDS = ("BattleStarted", "HillHeld", "PickUpLaid", "PickedUp")


def marks(recorded: Iterable[tuple[float, str, Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """Of each its `kind` as in Place.msg, `x`, `y`, `radius` in m, and from when to when it was there, `since` and
    `until`, in s since the battle began; `until` is None for what was there to the end. A hill that nobody has ever
    held is not among them. `recorded`: Unix time in s, kind, fields.
    """
    began = 0.0
    hills: dict[tuple[float, float], dict[str, Any]] = {}
    found: list[dict[str, Any]] = []
    lying: dict[str, dict[str, Any]] = {}  # by zone
    for at, kind, data in recorded:
        match kind:
            case "BattleStarted":
                began = at
            case "HillHeld":
                hills.setdefault((data["x"], data["y"]), _mark("hill", data, 0.0))
            case "PickUpLaid":
                lying[data["zone"]] = _mark(data["kind"], data, at - began)
                found.append(lying[data["zone"]])
            case "PickedUp" if data["zone"] in lying:
                lying.pop(data["zone"])["until"] = at - began
    return [*hills.values(), *found]


def _mark(kind: str, data: Mapping[str, Any], since: float) -> dict[str, Any]:
    where = {name: data[name] for name in ("x", "y", "radius")}
    return {"kind": PLACES.index(kind), **where, "since": since, "until": None}
