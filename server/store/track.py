"""Where the robots were in a battle, for its replay: taken from what is seen of them, kept in pieces. Pure.

A track costs little, whatever is seen: at most `RATE` times a second, fewer when there are many robots or much time.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

RATE = 5.0  # positions of a robot a second, at most
MAX_POINTS = 12_000  # positions of all robots until the battle's time limit, or in its first SPAN
SPAN = 600.0  # s; few battles last longer, whatever their limit
PIECE = 10.0  # s of a piece: a server that is killed loses no more
COVERED = 1.5  # s; a covered robot has a place for 1 s, so that whoever tells of it says something new by then

Pose = tuple[float, float, float]  # x and y in m, heading in rad, counter-clockwise from x
Sighting = Pose | tuple[float, float, float, bool]  # True: it was covered, and that is only predicted
Wall = tuple[float, float, float, float]  # from x, y to x, y, in m


@dataclass(frozen=True, slots=True)
class Floor:
    """From corner 0, 0; in m."""

    width: float
    height: float
    walls: tuple[Wall, ...]

    @property
    def is_real(self) -> bool:
        numbers = (self.width, self.height, *(number for wall in self.walls for number in wall))
        return all(map(math.isfinite, numbers)) and self.width > 0 and self.height > 0


@dataclass(slots=True)
class Piece:
    """Some seconds of a battle; for each time (monotonic s) and robot where it was, None if it was not seen."""

    battle: int  # number
    floor: Floor
    times: list[float] = field(default_factory=list)
    robots: dict[int, list[Sighting | None]] = field(default_factory=dict)

    def to_json(self, began: float) -> dict[str, Any]:
        """As it is kept: times in s since the battle began, to 10 ms; mm, degrees."""
        floor = self.floor
        return {
            "floor": {
                "width": round(floor.width, 3),
                "height": round(floor.height, 3),
                "walls": [[round(number, 3) for number in wall] for wall in floor.walls],
            },
            "times": [round(at - began, 2) for at in self.times],
            "robots": {str(robot): [pose and _rounded(pose) for pose in seen] for robot, seen in self.robots.items()},
        }


class Covered:
    """The robots that are not seen, by ID, as somebody tells who may be gone. Times in monotonic s."""

    def __init__(self) -> None:
        self._robots: Collection[int] = ()
        self._heard = -math.inf

    def hear(self, robots: Collection[int], now: float) -> None:
        self._robots, self._heard = frozenset(robots), now

    def at(self, now: float) -> Collection[int]:
        """None of them once nothing new has been told for longer than a covered robot has a place."""
        return self._robots if now - self._heard <= COVERED else ()


class Track:
    """Of one battle, which these robots fight, with so many `seconds` to its time limit."""

    def __init__(self, battle: int, robots: Collection[int], seconds: float) -> None:
        self.battle = battle
        self._robots = sorted(robots)
        self._seconds = min(max(seconds, 1.0), SPAN)
        self._period = max(1 / RATE, len(self._robots) * self._seconds / MAX_POINTS)
        self._due = -math.inf
        self._began: float | None = None
        self._piece: Piece | None = None

    def add(self, robots: Collection[int]) -> None:
        """These fight, too, by now."""
        self._robots = sorted({*self._robots, *robots})

    def see(self, at: float, floor: Floor, poses: Mapping[int, Pose], covered: Collection[int] = ()) -> Piece | None:
        """What is seen at `at` (monotonic s), but for the robots that are `covered`; returns the piece that is complete
        by it."""
        if at < self._due or not floor.is_real:
            return None
        if self._began is None:
            self._began = at
        # a battle that lasts longer is told ever more coarsely: the whole stays below twice MAX_POINTS
        period = self._period * 2 ** int((at - self._began) / self._seconds)
        self._due = max(self._due, at - period) + period  # one that comes late does not thin the next ones
        done = None
        piece = self._piece
        if piece and (piece.floor != floor or at - piece.times[0] >= PIECE or piece.robots.keys() != {*self._robots}):
            done = self.take()
        if self._piece is None:
            self._piece = Piece(self.battle, floor, robots={robot: [] for robot in self._robots})
        self._piece.times.append(at)
        for robot, seen in self._piece.robots.items():
            pose = poses.get(robot)
            if pose is None or not all(map(math.isfinite, pose)):
                seen.append(None)
            else:
                seen.append((*pose, True) if robot in covered else pose)
        return done

    def take(self) -> Piece | None:
        """The piece that is not complete yet, if something was seen."""
        piece, self._piece = self._piece, None
        return piece


def join(pieces: Iterable[Mapping[str, Any]]) -> dict[str, Any] | None:
    """The whole track, like one piece: `pieces` as they are kept, in their order. None if nothing was seen.

    A piece may be there twice: a database can do what it was told and not say so.
    """
    times: list[float] = []
    robots: dict[str, list[Sequence[float] | None]] = {}
    floor = None
    for piece in pieces:
        new = [place for place, at in enumerate(piece["times"]) if not times or at > times[-1]]
        for robot, seen in piece["robots"].items():
            robots.setdefault(robot, [None] * len(times)).extend(seen[place] for place in new)
        times += [piece["times"][place] for place in new]
        for seen in robots.values():
            seen.extend([None] * (len(times) - len(seen)))
        floor = piece["floor"]
    return {"floor": floor, "times": times, "robots": robots} if times else None


def _rounded(sighting: Sighting) -> tuple[float | bool, ...]:
    x, y, heading, *covered = sighting
    return round(x, 3), round(y, 3), round(math.degrees(heading)) % 360, *covered
