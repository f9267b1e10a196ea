"""How far a robot's clock is from this machine's, told by when its pictures get here. Pure."""

WINDOW = 30.0  # s; a sample counts for one to two of them, as clocks drift, and the way to a robot changes
# A picture is never so late: the connection would have ended. The robot's clock has been set.
JUMP = 10.0  # s


class ClockOffset:
    """This machine's clock minus the robot's, as far as the shortest way of a picture tells. All times are in s.

    What the shortest way itself takes cannot be told from the clocks' difference.
    """

    def __init__(self) -> None:
        self._offset = float("inf")  # the smallest sample of this window,
        self._before = float("inf")  # and that of the window before
        self._began = float("-inf")

    def sample(self, sent: float, received: float) -> float:
        """A picture was sent at `sent` by the robot's clock, and was here at `received` by this machine's; the offset
        that is known now."""
        offset = received - sent
        if offset - min(self._offset, self._before) > JUMP:
            self._offset = self._before = float("inf")
        if not 0 <= received - self._began < WINDOW:
            self._before = self._offset if received - self._began < 2 * WINDOW else float("inf")
            self._offset, self._began = float("inf"), received
        self._offset = min(self._offset, offset)
        return min(self._offset, self._before)
