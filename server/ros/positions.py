"""Where the robots are, by `/positions`: the track of each battle, and the rules of place. Needs an initialised node.

Without such a topic there are neither, and everything else is as usual.
"""

import math
import threading
import time
from collections.abc import Callable

import rospy

from laser_bot_battle.msg import OverheadCovered, Positions
from laser_bot_battle.names import OVERHEAD_COVERED, POSITIONS, Game
from server.game.loop import GameLoop
from server.game.snapshot import Snapshot
from server.store.track import Covered, Floor, Piece, Pose, Track


class PositionsListener:
    """Gives `keep` the pieces of each battle's track, in order, and tells `game` what it sees; neither may block."""

    def __init__(self, keep: Callable[[Piece], None], game: GameLoop) -> None:
        self._keep, self._game = keep, game
        self._lock = threading.Lock()
        self._track: Track | None = None
        self._covered = Covered()
        rospy.Subscriber(OVERHEAD_COVERED, OverheadCovered, self._hear_covered, queue_size=1)
        rospy.Subscriber(POSITIONS, Positions, self._see, queue_size=1)

    def follow(self, snapshot: Snapshot) -> None:
        """A listener of the game; does not block."""
        battle = snapshot.battle if snapshot.game is Game.PLAYING else None
        robots = [player.robot for player in snapshot.players if player.ready]
        with self._lock:
            if self._track and self._track.battle == battle:
                self._track.add(robots)
                return
            self._end()
            if battle is not None:
                self._track = Track(battle, robots, snapshot.time_left)

    def stop(self) -> None:
        with self._lock:
            self._end()

    def _end(self) -> None:
        piece = self._track and self._track.take()
        self._track = None
        if piece:
            self._keep(piece)

    def _hear_covered(self, message: OverheadCovered) -> None:
        with self._lock:
            self._covered.hear(message.robots, time.monotonic())

    def _see(self, message: Positions) -> None:
        now = time.monotonic()
        floor, poses = from_message(message)
        if floor.is_real:
            self._game.see(
                floor.walls,
                {robot: pose for robot, pose in poses.items() if all(map(math.isfinite, pose))},
                (floor.width, floor.height),
            )
        with self._lock:
            piece = self._track and self._track.see(now, floor, poses, self._covered.at(now))
            if piece:
                self._keep(piece)


def from_message(message: Positions) -> tuple[Floor, dict[int, Pose]]:
    """The floor, and by ID where the robots are."""
    ends = iter(message.walls)
    walls = tuple(zip(ends, ends, ends, ends, strict=False))  # what is left of an incomplete one is nothing
    poses = {one.robot: (one.x, one.y, one.heading) for one in message.robots}
    return Floor(message.width, message.height, walls), poses
