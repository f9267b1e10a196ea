"""How a battle went for each fighter, from its events. Pure."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from server.game.users import FULL_LIFE

# the events that matter here, by server.game.events
KINDS = (
    "BattleStarted",
    "Joined",
    "Hit",
    "HitRefused",
    "PickedUp",
    "Fenced",
    "HillHeld",
    "Left",
    "Unseated",
    "RobotGone",
    "Paused",
    "Resumed",
    "BattleEnded",
)
_WHAT = {"HitRefused": "refused", "Fenced": "fence", "HillHeld": "hill"}  # Change.what, where the event does not tell

Hill = tuple[float, float]  # x and y of its middle


class Change(NamedTuple):
    """Of a fighter."""

    at: float
    what: str  # "hit", "refused" for one that has cost no life, "fence", "hill" for taking it, or what was picked up
    life: int  # since then
    by: str = ""  # of the first two: who has shot, if the light tells


@dataclass(slots=True)
class Course:
    """All times are seconds since the battle began."""

    name: str
    robot: int
    avatar: int
    joined: float = 0.0  # when the fighter began; 0: with the battle
    first: int = FULL_LIFE  # life then
    changes: list[Change] = field(default_factory=list)
    out: float | None = None  # when the fighter died or left, whichever came first
    left: float | None = None
    team: int = 0  # 0: fought alone
    given: int | None = 0  # hits, of others than the own team; None: of some hits of the battle nobody knows whose
    kills: int | None = 0  # likewise
    paused: float = 0.0  # s of pauses, until the fighter was out

    @property
    def life(self) -> int:
        """What was left at the end."""
        return self.changes[-1].life if self.changes else self.first

    @property
    def hits(self) -> int:
        """Taken."""
        return sum(change.what == "hit" for change in self.changes)

    def fought(self, lasted: float) -> float:
        """Seconds in a battle that has lasted so long; pauses do not count."""
        return (lasted if self.out is None else min(self.out, lasted)) - self.joined - self.paused

    def hit(self, at: float, life: int, by: str = "") -> None:
        self.changes.append(Change(at, "hit", life, by))
        if life == 0:
            self.out = at

    def give(self, is_kill: bool) -> None:
        """Has hit somebody."""
        if self.given is not None and self.kills is not None:
            self.given += 1
            self.kills += is_kill

    def leave_out(self, paused_at: float | None, at: float) -> None:
        """A pause, if there is one, that ends for this fighter."""
        if paused_at is not None and self.out is None:
            self.paused += at - paused_at

    def leave(self, at: float, paused_at: float | None) -> None:
        self.leave_out(paused_at, at)
        if self.left is None:
            self.left = at
        if self.out is None:
            self.out = at


def courses(recorded: Iterable[tuple[float, str, Mapping[str, Any]]]) -> list[Course]:
    """The courses of one battle's fighters, from its events as they are kept: Unix time in s, kind, fields."""
    found: list[Course] = []
    began, paused_at = 0.0, None
    holders: dict[Hill, int | str] = {}  # the team, or who fights alone
    for at, kind, data in recorded:
        now = at - began
        match kind:
            case "BattleStarted":
                began, paused_at = at, None
                found = [
                    Course(one["name"], one["robot"], one["avatar"], team=one.get("team", 0))
                    for one in data["fighters"]
                ]
            case "Joined":
                found.append(Course(data["name"], data["robot"], data["avatar"], now, data["life"]))
            case "Hit":
                _hit(found, data, now)
            case "HitRefused" | "PickedUp" | "Fenced" | "HillHeld":
                _note(found, kind, data, now, holders)
            case "Left" | "Unseated" | "RobotGone":
                for course in found:
                    if course.robot == data["robot"] if kind == "RobotGone" else course.name == data["name"]:
                        course.leave(now, paused_at)
            case "Paused":
                paused_at = now
            case "Resumed" | "BattleEnded":
                for course in found:
                    course.leave_out(paused_at, now)
                paused_at = None
    return found


def _hit(found: Iterable[Course], data: Mapping[str, Any], now: float) -> None:
    by, team = data.get("by", ""), 0
    for course in found:
        if course.name == data["name"]:
            course.hit(now, data["life"], by)
            team = course.team
    for course in found:
        if not by:
            course.given = course.kills = None
        elif course.name == by and not (team and course.team == team):
            course.give(is_kill=data["life"] == 0)


def _note(
    found: Iterable[Course], kind: str, data: Mapping[str, Any], now: float, holders: dict[Hill, int | str]
) -> None:
    for course in found:
        if course.name == data["name"] and _is_news(kind, data, course, holders):
            what = _WHAT.get(kind) or data["kind"]
            course.changes.append(Change(now, what, data.get("life", course.life), data.get("by", "")))


def _is_news(kind: str, data: Mapping[str, Any], course: Course, holders: dict[Hill, int | str]) -> bool:
    """Who pushes against the edge again and again is stopped once, and a hill is taken once, for many seconds."""
    match kind:
        case "Fenced":
            is_again = bool(course.changes) and course.changes[-1].what == "fence"
            return (data["ahead"] or data["behind"]) and course.out is None and not is_again
        case "HillHeld":
            hill, side = (data["x"], data["y"]), course.team or course.name
            before, holders[hill] = holders.get(hill), side
            return before != side
        case _:
            return True
