"""The floor on which robots fight: its size, its walls, where robots start, its zones. One file of JSON says it to all:
docs/floor.md.

Lengths in m, angles in rad. The origin is the bottom left corner, x goes right, y up; heading 0 looks along x,
positive is counter-clockwise.
"""

import difflib
import json
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

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


def is_floor(text: str) -> bool:
    """Whether it can be meant as a floor's name or file."""
    return text.lower() in NAMES or "/" in text or text.endswith(".json")


def read_floor(name_or_path: str) -> Floor:
    """The floor of that name, or of the file there. SettingsError names the file, the field and what is wrong."""
    is_name = name_or_path.lower() in NAMES
    path = FOLDER / f"{name_or_path.lower()}.json" if is_name else Path(name_or_path)
    if not is_floor(name_or_path):
        raise SettingsError(f"{name_or_path}: there is no such floor; there are {', '.join(NAMES)}, and files (.json)")
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise SettingsError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        return parse_floor(data)
    except ValueError as error:
        raise SettingsError(f"{path}: {error}") from None


def parse_floor(data: bytes) -> Floor:
    """The floor that a file describes. ValueError names the field and what is wrong."""
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
    width, height = (_number(name, fields[name], *SIDES) for name in ("width", "height"))

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

    floor = Floor.of(
        width,
        height,
        tuple(wall(*one) for one in _each("walls", fields, MAX_WALLS)),
        [start(*one) for one in _each("starts", fields, MAX_STARTS)],
        tuple(zone(*one) for one in _each("zones", fields, MAX_ZONES)),
    )
    _check(floor)
    return floor


def _check(floor: Floor) -> None:
    """ValueError for what does not fit together."""
    if not floor.starts:
        raise ValueError("starts: must have one place at least")
    for number, (x, y, _) in enumerate(floor.starts):
        if any(_distance(x, y, wall) < ROBOT_RADIUS - _ROUNDING for wall in floor.walls):
            raise ValueError(f"starts[{number}]: a robot does not fit: it needs {ROBOT_RADIUS:g} m to each wall")
        for other, (there_x, there_y, _) in enumerate(floor.starts[:number]):
            if math.dist((x, y), (there_x, there_y)) < 2 * ROBOT_RADIUS - _ROUNDING:
                raise ValueError(f"starts[{number}]: two robots do not fit here and at starts[{other}]")
    names = [zone.name for zone in floor.zones]
    for number, name in enumerate(names):
        if name in names[:number]:
            raise ValueError(f"zones[{number}]: name: another zone has {name!r}, too")


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


def _each(name: str, fields: dict[str, Any], most: int) -> list[tuple[str, Any]]:
    """The parts of a list, each after what to call it."""
    given = fields.get(name, [])
    if not isinstance(given, list) or len(given) > most:
        raise ValueError(f"{name}: must be a list of at most {most}")
    return [(f"{name}[{number}]", part) for number, part in enumerate(given)]


def _list(field: str, given: Any, sizes: tuple[int, ...], what: str) -> list[Any]:
    if not isinstance(given, list) or len(given) not in sizes:
        raise ValueError(f"{field}: must be [{what}]")
    return given


def _number(field: str, given: Any, lowest: float, highest: float) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not lowest <= given <= highest:
        raise ValueError(f"{field}: must be a number from {lowest:g} to {highest:g}")
    return float(given)
