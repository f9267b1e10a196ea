"""The shots that drivers command, told to the referee on /shots."""

from laser_bot_battle.msg import Shot
from laser_bot_battle.names import ROBOT_IDS, SHOTS, command_topic
from server.rosbridge.effects import Publish

SHOT_TYPE = Shot._type
COOLDOWN = 0.5  # s from the start of one shot to the next, of a robot
_EARLY = 0.03  # s; commands come every 25 ms, and the robot must not fire before the referee knows of it
_ROBOTS = {command_topic(robot_id): robot_id for robot_id in ROBOT_IDS}
_SHOOT = 2  # place of the flag in a serialized Robot_msg


class Shots:
    """Which commands to shoot the robots can follow. `now` is a monotonic clock in s."""

    def __init__(self) -> None:
        self._next: dict[str, float] = {}  # by command topic, when the robot may shoot again

    def commanded(self, topic: str, command: bytes, now: float) -> list[Publish]:
        """The news of the shot that the serialized `command` is, if it is one."""
        if not command[_SHOOT]:
            return []
        due = self._next.get(topic, now)
        if now < due - _EARLY:
            return []
        self._next[topic] = max(due, now) + COOLDOWN
        return [Publish(SHOTS, bytes([_ROBOTS[topic]]))]
