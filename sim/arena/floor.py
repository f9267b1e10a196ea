"""The arena's floor: its size, its walls and where robots start."""

from dataclasses import dataclass

from sim.arena.geometry import Point, Pose, Wall, bearing


@dataclass(frozen=True)
class Floor:
    """A rectangle `width` x `height` m with `walls` (the four outer ones included) and start positions."""

    width: float
    height: float
    walls: tuple[Wall, ...]
    spawns: tuple[Pose, ...]


def make_floor(width: float, height: float, inner: tuple[Wall, ...], starts: tuple[Point, ...]) -> Floor:
    """A floor with its outer walls; every start position faces the centre."""
    outer: tuple[Wall, ...] = (
        (0, 0, width, 0),
        (width, 0, width, height),
        (width, height, 0, height),
        (0, height, 0, 0),
    )
    centre = (width / 2, height / 2)
    return Floor(width, height, outer + inner, tuple(Pose(*start, bearing(start, centre)) for start in starts))


# Point-symmetric, so that no corner is better than its opposite. A robot (0.15 m) fits through every gap.
# The first two start diagonally and do not see each other: the centre wall is between them.
BATTLE_FLOOR = make_floor(
    1.6,
    1.2,
    inner=(
        (0.80, 0.47, 0.80, 0.73),
        (0.38, 0.40, 0.58, 0.40),
        (0.38, 0.40, 0.38, 0.56),
        (1.22, 0.80, 1.02, 0.80),
        (1.22, 0.80, 1.22, 0.64),
        (0.40, 0.80, 0.54, 0.94),
        (1.20, 0.40, 1.06, 0.26),
    ),
    starts=(
        (0.17, 0.17),
        (1.43, 1.03),
        (0.17, 1.03),
        (1.43, 0.17),
        (0.80, 0.15),
        (0.80, 1.05),
        (0.15, 0.60),
        (1.45, 0.60),
    ),
)

# Each robot has the one opposite in its beam from the start: for a duel of a minute, and for tests.
DUEL_FLOOR = make_floor(
    1.0,
    0.8,
    inner=(),
    starts=(
        (0.25, 0.25),
        (0.75, 0.55),
        (0.25, 0.55),
        (0.75, 0.25),
        (0.50, 0.15),
        (0.50, 0.65),
        (0.12, 0.40),
        (0.88, 0.40),
    ),
)

FLOORS = {"battle": BATTLE_FLOOR, "duel": DUEL_FLOOR}
