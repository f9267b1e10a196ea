"""The floor on which robots fight: its size, its walls, where robots start, its zones. One file of JSON says it to all:
docs/floor.md.

Lengths in m, angles in rad. The origin is the bottom left corner, x goes right, y up; heading 0 looks along x,
positive is counter-clockwise.
"""

import difflib
import json
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from laser_bot_battle.settings import SettingsError

ROBOT_RADIUS = 0.075  # m; the round chassis, wheels included
FOLDER = Path(__file__).with_name("floors")
NAMES = tuple(sorted(path.stem for path in FOLDER.glob("*.json")))
KINDS = ("hill", "pick-up")  # of zones

SIDES = (0.4, 20.0)  # m, of a floor
SHORTEST_WALL = 0.01  # m
MAX_WALLS, MAX_STARTS, MAX_ZONES = 200, 64, 32
MAX_BYTES = 100_000
_ROUNDING = 1e-9

Part = TypeVar("Part")
Wall = tuple[float, float, float, float]  # x1, y1, x2, y2
Start = tuple[float, float, float]  # x, y, heading


@dataclass(frozen=True)
class Zone:
    """A disc on the floor that means something in the game."""

    name: str
    kind: str  # one of KINDS
    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class Floor:
    """A rectangle `width` x `height` m with `walls` (the four outer ones first), start places and zones."""

    width: float
    height: float
    walls: tuple[Wall, ...]
    starts: tuple[Start, ...]
    zones: tuple[Zone, ...] = ()

    @classmethod
    def of(
        cls,
        width: float,
        height: float,
        inner: tuple[Wall, ...] = (),
        starts: Iterable[tuple[float, ...]] = (),
        zones: tuple[Zone, ...] = (),
    ) -> "Floor":
        """With outer walls around the `inner` ones; a start of just x, y looks at the middle."""
        outer: tuple[Wall, ...] = (
            (0, 0, width, 0),
            (width, 0, width, height),
            (width, height, 0, height),
            (0, height, 0, 0),
        )
        looking = (
            (x, y, heading[0] if heading else math.atan2(height / 2 - y, width / 2 - x)) for x, y, *heading in starts
        )
        return cls(width, height, outer + inner, tuple(looking), zones)


class FloorError(ValueError):
    """What is described cannot be a floor. `problems` has all that is wrong, each after the part that it is about:
    `walls[3]: must be at least 0.01 m long`; the error's own text is the first."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__(problems[0])
        self.problems = tuple(problems)


def is_floor(text: str) -> bool:
    """Whether it can be meant as a floor's name or file."""
    return text.lower() in NAMES or "/" in text or text.endswith(".json")


def floor_file(name_or_path: str) -> Path:
    """Where the floor of that name, or of that path, is described."""
    is_name = name_or_path.lower() in NAMES
    return FOLDER / f"{name_or_path.lower()}.json" if is_name else Path(name_or_path)


def read_floor(name_or_path: str) -> Floor:
    """The floor of that name, or of the file there. SettingsError names the file, the field and what is wrong."""
    if not is_floor(name_or_path):
        raise SettingsError(f"{name_or_path}: there is no such floor; there are {', '.join(NAMES)}, and files (.json)")
    path = floor_file(name_or_path)
    try:
        return parse_floor(read_bytes(path))
    except OSError as error:
        raise SettingsError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise SettingsError(f"{path}: {error}") from None


def read_bytes(path: Path) -> bytes:
    """What is in a floor's file, or more than there may be of it. OSError if it cannot be read."""
    with path.open("rb") as file:
        return file.read(MAX_BYTES + 1)


def parse_floor(data: bytes) -> Floor:
    """The floor that a file describes. ValueError names the field and what is wrong: a FloorError, if it is about parts
    of the floor."""
    if len(data) > MAX_BYTES:
        raise ValueError(f"is larger than {MAX_BYTES} bytes")
    try:
        found = json.loads(data, object_pairs_hook=_once, parse_constant=_no_number)
    except RecursionError:
        raise ValueError("is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"line {error.lineno}, column {error.colno}: is no JSON: {error.msg}") from None
    except UnicodeDecodeError:
        raise ValueError("is no UTF-8 text") from None
    fields = _fields("the file", found, ("width", "height"), ("walls", "starts", "zones"))
    problems = _Problems()
    width, height = (problems.caught(_number, name, fields[name], *SIDES) for name in ("width", "height"))
    if width is None or height is None:
        raise FloorError(problems)

    def place(field: str, x: Any, y: Any) -> tuple[float, float]:
        return _number(f"{field}: x", x, 0, width), _number(f"{field}: y", y, 0, height)

    def wall(field: str, given: Any) -> Wall:
        x1, y1, x2, y2 = _list(field, given, (4,), "x1, y1, x2, y2")
        (x1, y1), (x2, y2) = place(field, x1, y1), place(field, x2, y2)
        if math.dist((x1, y1), (x2, y2)) < SHORTEST_WALL:
            raise ValueError(f"{field}: must be at least {SHORTEST_WALL:g} m long")
        return x1, y1, x2, y2

    def start(field: str, given: Any) -> tuple[float, ...]:
        x, y, *heading = _list(field, given, (2, 3), "x, y, perhaps with a heading")
        turn = [_number(f"{field}: heading", angle, -math.tau, math.tau) for angle in heading]
        return *place(field, x, y), *turn

    def zone(field: str, given: Any) -> Zone:
        fields = _fields(field, given, ("name", "kind", "x", "y", "radius"))
        name, kind = fields["name"], fields["kind"]
        if not (isinstance(name, str) and re.fullmatch(r"[\w -]{1,40}", name)):
            raise ValueError(f"{field}: name: must be 1 to 40 letters, digits, spaces, _ or -")
        if kind not in KINDS:
            raise ValueError(f"{field}: kind: must be one of {', '.join(KINDS)}")
        radius = _number(f"{field}: radius", fields["radius"], 0.05, max(SIDES))
        return Zone(name, kind, *place(field, fields["x"], fields["y"]), radius)

    def each(name: str, most: int, read: Callable[[str, Any], Part]) -> dict[str, Part]:
        """Those of a list that are right, by what to call them."""
        given = problems.caught(_several, name, fields.get(name, []), most) or []
        parts = {f"{name}[{number}]": part for number, part in enumerate(given)}
        found = {field: problems.caught(read, field, part) for field, part in parts.items()}
        return {field: part for field, part in found.items() if part is not None}

    walls, zones = each("walls", MAX_WALLS, wall), each("zones", MAX_ZONES, zone)
    starts = each("starts", MAX_STARTS, start)
    if not fields.get("starts"):
        problems.append("starts: must have one place at least")
    floor = Floor.of(width, height, tuple(walls.values()), starts.values(), tuple(zones.values()))
    _check_starts(dict(zip(starts, floor.starts, strict=True)), floor.walls, problems)
    _check_names(zones, problems)
    if problems:
        raise FloorError(problems)
    return floor


class _Problems(list[str]):
    def caught(self, read: Callable[..., Part], *arguments: Any) -> Part | None:
        """What `read` finds; None if it finds a problem."""
        try:
            return read(*arguments)
        except ValueError as error:
            self.append(str(error))
            return None


def _check_starts(starts: Mapping[str, Start], walls: Iterable[Wall], problems: list[str]) -> None:
    """Whether robots fit where they start."""
    before: dict[str, Start] = {}
    for field, (x, y, heading) in starts.items():
        if any(_distance(x, y, wall) < ROBOT_RADIUS - _ROUNDING for wall in walls):
            problems.append(f"{field}: a robot does not fit: it needs {ROBOT_RADIUS:g} m to each wall")
        for other, (there_x, there_y, _) in before.items():
            if math.dist((x, y), (there_x, there_y)) < 2 * ROBOT_RADIUS - _ROUNDING:
                problems.append(f"{field}: two robots do not fit here and at {other}")
        before[field] = x, y, heading


def _check_names(zones: Mapping[str, Zone], problems: list[str]) -> None:
    names: set[str] = set()
    for field, zone in zones.items():
        if zone.name in names:
            problems.append(f"{field}: name: another zone has {zone.name!r}, too")
        names.add(zone.name)


def _distance(x: float, y: float, wall: Wall) -> float:
    """From a point to a wall."""
    x1, y1, x2, y2 = wall
    across, up = x2 - x1, y2 - y1
    along = min(1.0, max(0.0, ((x - x1) * across + (y - y1) * up) / (across**2 + up**2)))
    return math.hypot(x - x1 - along * across, y - y1 - along * up)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    names = [name for name, _ in pairs]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{name}: is there twice")
    return dict(pairs)


def _no_number(text: str) -> NoReturn:
    raise ValueError(f"{text} is no number")


def _fields(field: str, given: Any, needed: tuple[str, ...], optional: tuple[str, ...] = ()) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise ValueError(f"{field}: must be an object with {', '.join(needed + optional)}")
    for name in given:
        if name not in needed + optional:
            nearest = difflib.get_close_matches(name, needed + optional, 1)
            hint = f"the nearest is {nearest[0]}" if nearest else f"there are {', '.join(needed + optional)}"
            raise ValueError(f"{field}: {name}: there is no such field; {hint}")
    for name in needed:
        if name not in given:
            raise ValueError(f"{field}: {name}: is missing")
    return given


def _several(field: str, given: Any, most: int) -> list[Any]:
    if not isinstance(given, list) or len(given) > most:
        raise ValueError(f"{field}: must be a list of at most {most}")
    return given


def _list(field: str, given: Any, sizes: tuple[int, ...], what: str) -> list[Any]:
    if not isinstance(given, list) or len(given) not in sizes:
        raise ValueError(f"{field}: must be [{what}]")
    return given


def _number(field: str, given: Any, lowest: float, highest: float) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not lowest <= given <= highest:
        raise ValueError(f"{field}: must be a number from {lowest:g} to {highest:g}")
    return float(given)
