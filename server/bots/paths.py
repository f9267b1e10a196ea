"""Paths around the walls of the arena, for a bot. Pure."""

import math
from collections import deque
from collections.abc import Sequence

from laser_bot_battle.geometry import ROBOT_RADIUS, Point, Wall, nearest_on_wall

CELL = 0.04  # m; the floor is searched as a grid of such squares, larger ones on a large floor:
MOST_CELLS = 15_000  # a search takes 20 ms then
CLEARANCE = ROBOT_RADIUS + 0.015  # m from walls, so that a robot that is a little off its path does not touch
PROBE = 0.02  # m between the checked points of a straight line

Cell = tuple[int, int]
_STEPS = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]


class Paths:
    """A floor of `width` x `height` m with `walls`, the outer ones included."""

    def __init__(self, width: float, height: float, walls: Sequence[Wall]) -> None:
        self.walls = tuple(walls)
        self._cell = max(CELL, math.sqrt(width * height / MOST_CELLS))
        cells = [(i, j) for i in range(int(width / self._cell)) for j in range(int(height / self._cell))]
        self._free = {cell for cell in cells if self.has_room(self._centre(cell))}

    def has_room(self, point: Point) -> bool:
        """Whether a robot can stand there with some clearance."""
        return all(math.dist(point, nearest_on_wall(point, wall)) >= CLEARANCE for wall in self.walls)

    def places(self) -> list[Point]:
        """Points all over the floor at which a robot can stand."""
        return [self._centre(cell) for cell in sorted(self._free)]

    def next_point(self, start: Point, goal: Point) -> Point:
        """Where to drive straight to from `start` on a path to `goal`: `goal` itself if nothing is in between."""
        if not self._free or self._is_straight(start, goal):
            return goal
        first, last = self._nearest_free(start), self._nearest_free(goal)
        towards = self._search(last)
        if first not in towards:
            return goal
        path = [first]
        while path[-1] != last:
            path.append(towards[path[-1]])
        point = self._centre(first)
        for cell in path:
            if not self._is_straight(start, self._centre(cell)):
                break
            point = self._centre(cell)
        return point

    def _is_straight(self, start: Point, end: Point) -> bool:
        probes = max(1, math.ceil(math.dist(start, end) / PROBE))
        return all(
            self.has_room((start[0] + (end[0] - start[0]) * n / probes, start[1] + (end[1] - start[1]) * n / probes))
            for n in range(1, probes + 1)
        )

    def _nearest_free(self, point: Point) -> Cell:
        own = (int(point[0] / self._cell), int(point[1] / self._cell))
        return own if own in self._free else min(self._free, key=lambda cell: math.dist(point, self._centre(cell)))

    def _search(self, goal: Cell) -> dict[Cell, Cell]:
        """From each cell that can reach `goal`, the next cell on a shortest path."""
        towards = {goal: goal}
        edge = deque([goal])
        while edge:
            cell = edge.popleft()
            for dx, dy in _STEPS:
                near = (cell[0] + dx, cell[1] + dy)
                if near in self._free and near not in towards:
                    towards[near] = cell
                    edge.append(near)
        return towards

    def _centre(self, cell: Cell) -> Point:
        return (cell[0] + 0.5) * self._cell, (cell[1] + 0.5) * self._cell
