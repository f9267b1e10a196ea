"""The shots that drivers command, told to the referee on /shots."""

from laser_bot_battle.light_protocol import COOLDOWN, PLAIN_PERIOD
from laser_bot_battle.msg import Shot
from laser_bot_battle.names import ROBOT_IDS, SHOTS, command_topic
from server.rosbridge.effects import Publish

SHOT_TYPE = Shot._type
# s; a robot takes a command that comes so shortly before its time (50 ms, docs/protocol-light.md), and must not fire
# before the referee knows of it
_EARLY = 0.06
_ROBOTS = {command_topic(robot_id): robot_id for robot_id in ROBOT_IDS}
_SHOOT = 2  # place of the flag in a serialized Robot_msg


class Shots:
    """Which commands to shoot the robots can follow. `now` is a monotonic clock in s."""

    def __init__(self) -> None:
        self._next: dict[str, float] = {}  # by command topic, when the robot may shoot again

    def commanded(self, topic: str, command: bytes, coded: bool, now: float) -> list[Publish]:
        """The news of the shot that the serialized `command` is, if it is one; `coded`: by coded light."""
        if not command[_SHOOT]:
            return []
        due = self._next.get(topic, now)
        if now < due - _EARLY:
            return []
        self._next[topic] = max(due, now) + (COOLDOWN if coded else PLAIN_PERIOD)
        return [Publish(SHOTS, bytes([_ROBOTS[topic]]))]
