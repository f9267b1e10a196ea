"""A battle as a picture: everyone's life over the time, as lines of an SVG. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass

from server.game.users import FULL_LIFE
from server.store.course import Course

WIDTH, HEIGHT = 1000, 400  # units of the view box, which is stretched to the room there is
_APART = 3.0  # units between lines of equal life, or one would hide the others
_TICKS = 5  # on the axis of time, at most
_STEPS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1200, 3600)  # s between ticks


@dataclass(frozen=True, slots=True)
class Line:
    """One fighter's. Both are paths; a mark is a line of no length with round ends, so that it stays a dot."""

    name: str
    robot: int
    path: str
    hits: str
    end: str  # where the fighter died or left, "" for those who stayed to the end


@dataclass(frozen=True, slots=True)
class Chart:
    lines: tuple[Line, ...]
    ticks: tuple[tuple[float, float], ...]  # on the axis of time: s, place in percent


def draw(courses: Sequence[Course], seconds: float) -> Chart:
    """The chart of a battle that lasted so long."""
    length = max(seconds, 1.0)
    step = next((step for step in _STEPS if length / step <= _TICKS), _STEPS[-1])
    ticks = tuple((float(at), 100 * at / length) for at in range(0, int(length) + 1, step))
    return Chart(tuple(_line(course, place, length) for place, course in enumerate(courses)), ticks)


def _line(course: Course, place: int, length: float) -> Line:
    def x(at: float) -> str:
        return f"{min(max(at, 0.0), length) / length * WIDTH:.1f}"

    def y(life: int) -> str:
        return f"{(1 - life / FULL_LIFE) * HEIGHT + place * _APART:.1f}"

    life = course.first
    path = f"M{x(course.joined) if course.joined else 0} {y(life)}"
    for at, _, life, _ in course.changes:
        path += f"H{x(at)}V{y(life)}"
    end = length if course.out is None else course.out
    return Line(
        name=course.name,
        robot=course.robot,
        path=f"{path}H{x(end)}",
        hits="".join(f"M{x(at)} {y(now)}h0" for at, what, now, _ in course.changes if what == "hit"),
        end="" if course.out is None else f"M{x(end)} {y(life)}h0",
    )
