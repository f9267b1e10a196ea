"""What was on the floor of a battle, and what it did to whom, for its replay, from its events. Pure.

`recorded` are a battle's events as they are kept: Unix time in s, kind, fields. `since` and `until` are in s since it
began; `until` is None for what was so to the end.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from server.game.snapshot import PLACES

# the events that matter to `marks`, `points` and `effects`, by server.game.events
ON_FLOOR = ("BattleStarted", "HillOpened", "HillHeld", "PickUpLaid", "PickedUp")
ON_HILLS = ("BattleStarted", "HillHeld")
ON_ROBOTS = ("BattleStarted", "PickedUp", "EffectEnded", "Left", "Unseated", "RobotGone", "BattleEnded")

Events = Iterable[tuple[float, str, Mapping[str, Any]]]


def marks(recorded: Events) -> list[dict[str, Any]]:
    """Hills and pick-ups: of each its `kind` as in Place.msg, `x`, `y`, `radius` in m, `since` and `until`."""
    began = 0.0
    hills: dict[tuple[float, float], dict[str, Any]] = {}
    found: list[dict[str, Any]] = []
    lying: dict[str, dict[str, Any]] = {}  # by zone
    for at, kind, data in recorded:
        match kind:
            case "BattleStarted":
                began = at
            case "HillOpened" | "HillHeld":  # an older server told of hills only when somebody held them
                hills.setdefault((data["x"], data["y"]), _mark("hill", data, 0.0))
            case "PickUpLaid":
                lying[data["zone"]] = _mark(data["kind"], data, at - began)
                found.append(lying[data["zone"]])
            case "PickedUp" if data["zone"] in lying:
                lying.pop(data["zone"])["until"] = at - began
    return [*hills.values(), *found]


def effects(recorded: Events) -> list[dict[str, Any]]:
    """What was picked up and worked for a while: of each `name` of whom, `what`, `since` and `until`."""
    began = 0.0
    found: list[dict[str, Any]] = []
    working: dict[tuple[int, str], dict[str, Any]] = {}  # by robot and kind
    for at, kind, data in recorded:
        match kind:
            case "BattleStarted":
                began = at
            case "PickedUp" if data["seconds"] and (data["robot"], data["kind"]) not in working:
                effect = {"name": data["name"], "what": data["kind"], "since": at - began, "until": None}
                working[data["robot"], data["kind"]] = effect
                found.append(effect)
            case "EffectEnded" | "Left" | "Unseated" | "RobotGone" | "BattleEnded":
                for key, effect in tuple(working.items()):
                    if _ends(kind, data, key, effect["name"]):
                        working.pop(key)["until"] = at - began
    return found


def points(recorded: Events) -> list[dict[str, Any]]:
    """Each second on a hill: `at` in s since the battle began, `name` of whom, and `points` since then."""
    began = 0.0
    found = []
    for at, kind, data in recorded:
        match kind:
            case "BattleStarted":
                began = at
            case "HillHeld":
                found.append({"at": at - began, "name": data["name"], "points": data["points"]})
    return found


def _ends(kind: str, data: Mapping[str, Any], effect: tuple[int, str], name: str) -> bool:
    match kind:
        case "EffectEnded":
            return bool(effect == (data["robot"], data["kind"]))
        case "RobotGone":
            return bool(effect[0] == data["robot"])
        case "Left" | "Unseated":
            return bool(name == data["name"])
        case _:
            return True


def _mark(kind: str, data: Mapping[str, Any], since: float) -> dict[str, Any]:
    where = {name: data[name] for name in ("x", "y", "radius")}
    return {"kind": PLACES.index(kind), **where, "since": since, "until": None}
