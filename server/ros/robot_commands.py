"""What the server tells robots: how to shoot, on the latched `/Robot<ID>/setup`, and to show themselves, on
`/Robot<ID>/identify` (std_msgs/Empty). Needs an initialised node."""

from collections.abc import Sequence

import rospy
from std_msgs.msg import Empty

from laser_bot_battle.light_protocol import COOLDOWN
from laser_bot_battle.msg import Setup
from laser_bot_battle.names import identify_topic, setup_topic
from laser_bot_battle.rospy_cures import latched_publisher
from server.game.emitter import damage_code
from server.game.snapshot import Snapshot
from server.ros.robot_topics import Publication, RobotTopics


class RobotCommands(RobotTopics[Publication]):
    """Tells exactly the robots that are registered, and again when something changes for them."""

    def __init__(self) -> None:
        super().__init__()
        self._wanted: dict[int, Setup] = {}
        self._told: dict[int, Setup] = {}

    def follow(self, snapshot: Snapshot) -> None:
        """A listener of the game; does not block."""
        wanted = setups(snapshot)
        if wanted != self._wanted:
            self._wanted = wanted
            self._changed.set()
        super().follow(snapshot)

    def identify(self, robot_id: int) -> bool:
        """Whether there is somebody on the robot who can be asked to wiggle and flash. From any thread."""
        topics = self._opened.get(robot_id)
        if topics is None or not topics[1].is_connected():
            return False
        topics[1].tell(Empty())
        return True

    def _open(self, robot_id: int) -> Sequence[Publication]:
        self._told.pop(robot_id, None)
        return [
            Publication(latched_publisher(setup_topic(robot_id), Setup, queue_size=1)),
            Publication(rospy.Publisher(identify_topic(robot_id), Empty, queue_size=1)),
        ]

    def _settle(self, present: Sequence[int]) -> None:
        wanted = self._wanted
        super()._settle(present)
        for robot_id, topics in self._opened.items():
            setup = wanted.get(robot_id)
            if setup is not None and setup != self._told.get(robot_id):
                topics[0].tell(setup)
                self._told[robot_id] = setup


def setups(snapshot: Snapshot) -> dict[int, Setup]:
    """How each robot is to shoot. Its team is one less than its player's: the light has two bits for it."""
    teams = {player.robot: player.team for player in snapshot.players}
    mode = Setup.CODED if snapshot.coded else Setup.PLAIN
    cooldown, damage = round(COOLDOWN * 1000), damage_code(snapshot.damage)
    return {
        robot_id: Setup(robot_id, max(0, teams.get(robot_id, 0) - 1), mode, cooldown, damage)
        for robot_id in snapshot.robots
    }
