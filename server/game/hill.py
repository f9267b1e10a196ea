"""King of the hill: a second on a hill that nobody else is on is a point. Pure."""

import math
from collections.abc import Iterable, Mapping

from laser_bot_battle.floor import Zone
from server.game.sight import Moment

GAP = 0.5  # s; of a longer time between two looks, no more than this counts
SECOND = 1 - 1e-6  # s of a point; the sum of many looks is not exact


class Hill:
    """How long each robot has held hills since its last point."""

    def __init__(self) -> None:
        self._seen_at: float | None = None
        self._held: dict[int, float] = {}

    def see(self, moment: Moment, hills: Iterable[Zone], sides: Mapping[int, object]) -> list[tuple[int, Zone]]:
        """Which robots earn a point by how they stand now, and on which hill. `sides`: for whom each robot fights that
        is in the battle; those of one side are not in each other's way, and whoever is nearest to the middle earns."""
        passed = 0.0 if self._seen_at is None else min(GAP, moment.at - self._seen_at)
        self._seen_at = moment.at
        earned = []
        for hill in hills:
            robot = _holder(hill, moment, sides)
            if robot is None:
                continue
            self._held[robot] = self._held.get(robot, 0.0) + passed
            if self._held[robot] >= SECOND:
                self._held[robot] -= 1.0
                earned.append((robot, hill))
        return earned


def is_in(zone: Zone, pose: tuple[float, float, float]) -> bool:
    """Whether the middle of a robot is in it."""
    return math.hypot(pose[0] - zone.x, pose[1] - zone.y) <= zone.radius


def _holder(hill: Zone, moment: Moment, sides: Mapping[int, object]) -> int | None:
    """Of the one side that is there, the robot nearest to the middle."""
    there = {robot: moment.poses[robot] for robot in sides if robot in moment.poses}
    there = {robot: pose for robot, pose in there.items() if is_in(hill, pose)}
    if len({sides[robot] for robot in there}) != 1:
        return None
    return min(there, key=lambda robot: (math.dist(there[robot][:2], (hill.x, hill.y)), robot))
