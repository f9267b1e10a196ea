"""Where the robots are at this moment, by `/positions`. Pure; times are s of any steady clock.

Its messages come a few times a second, and tell of a moment ago. In 0.2 s a robot drives 14 mm or turns 13 degrees: so
a bot adds to where its own robot was seen what it has commanded since, and to where others were how they have moved.
"""

from collections import deque
from collections.abc import Mapping

from laser_bot_battle.geometry import Point, Pose, roll, wheel_speeds
from server.bots.game import Floor, Positions
from server.bots.mind import NEUTRAL, Command

AGE = 0.05  # s that a message is behind, when it comes: a camera's is more, the arena's less
OBEYED = 0.03  # s from a command to wheels that obey
MOST = 0.3  # s for which others are taken to drive on as they did
BLIND_AFTER = 1.0  # s without a message


class Sight:
    """What `/positions` tells of all robots: shared by all bots."""

    def __init__(self) -> None:
        self.floor: Floor | None = None
        """of the last message"""
        self._at = self._before_at = float("-inf")
        self._poses: Mapping[int, Pose] = {}
        self._before: Mapping[int, Pose] = {}

    def see(self, now: float, positions: Positions) -> None:
        """A message has come."""
        if self.floor != positions.floor:
            self.floor = positions.floor
        self._before, self._before_at = self._poses, self._at
        self._poses, self._at = positions.robots, now

    def is_blind(self, now: float) -> bool:
        """Whether nothing is known of the robots: a tracker that sees none keeps publishing."""
        return not self._poses or now - self._at > BLIND_AFTER

    def seen(self, robot: int, now: float) -> tuple[float, Pose] | None:
        """When that robot was last seen, and where; None: it is not seen."""
        pose = None if self.is_blind(now) else self._poses.get(robot)
        return None if pose is None else (self._at - AGE, pose)

    def points(self, now: float) -> dict[int, Point]:
        """About where all robots are."""
        return {} if self.is_blind(now) else {robot: self._moved(robot, now) for robot in self._poses}

    def _moved(self, robot: int, now: float) -> Point:
        pose, before = self._poses[robot], self._before.get(robot)
        gap = self._at - self._before_at
        if before is None or not 0 < gap <= BLIND_AFTER:
            return pose.point
        part = min(now - self._at + AGE, MOST) / gap
        return pose.x + (pose.x - before.x) * part, pose.y + (pose.y - before.y) * part


class OwnWay:
    """What a bot has commanded of late."""

    def __init__(self) -> None:
        self._commands: deque[tuple[float, Command]] = deque([(float("-inf"), NEUTRAL)])  # when the wheels obey

    def commanded(self, now: float, command: Command) -> None:
        """What has just been commanded; times never go back."""
        self._commands.append((now + OBEYED, command))
        while self._commands[1][0] < now - BLIND_AFTER - AGE:
            self._commands.popleft()

    def since(self, seen_at: float, pose: Pose, now: float) -> Pose:
        """Where the robot is that was there at that time."""
        ends = [*[at for at, _ in self._commands][1:], now]
        for (begins, command), end in zip(self._commands, ends, strict=True):
            seconds = min(end, now) - max(begins, seen_at)
            if seconds > 0:
                left, right = wheel_speeds(command.linear_x, command.angular_z)
                pose = roll(pose, left * seconds, right * seconds)
        return pose
