"""Robots that were switched off in order: nobody has lost them. Their programs have said so with a last ping."""

KEPT = 900.0  # s; an alert looks back for less (monitoring/rules.yml)


class Departures:
    """All times are monotonic, in s."""

    def __init__(self) -> None:
        self._left: dict[int, float] = {}

    def pinged(self, robot: int, *, leaving: bool, now: float) -> None:
        """A robot has said that it is there, or (`leaving`) that it is about to end."""
        if leaving:
            self._left[robot] = now
        else:
            self._left.pop(robot, None)

    def of_late(self, now: float) -> set[int]:
        """The robots that have left and not come back."""
        return {robot for robot, at in self._left.items() if now - at < KEPT}
