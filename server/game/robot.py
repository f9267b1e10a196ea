"""The registered robots (manual 3.1.5): a plain registry without locks, owned by the referee."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from laser_bot_battle.names import ROBOT_IDS

_ROS_NAME = re.compile(r"/[A-Za-z][A-Za-z0-9_/]{0,254}")
# what ROS calls nodes that gave no name: rospy without init_node, and anonymous nodes (name_pid_milliseconds)
_NAMELESS = re.compile(r"/unnamed|.*_\d+_\d{13}")


@dataclass
class Robot:
    """A robot that answers. `caller` is the ROS name of its client, None if it has no lasting one."""

    id: int
    caller: str | None
    alive_at: float  # monotonic seconds of the last registration or ping
    user: str | None = None


class Robots:
    """The robots by ID, and the IDs that are kept for named robots that were here before."""

    def __init__(self, known: Mapping[str, int] | None = None) -> None:
        self._robots: dict[int, Robot] = {}
        self._known = dict(known or {})

    def __iter__(self) -> Iterator[Robot]:
        """The robots in the order of their IDs."""
        return iter([self._robots[robot_id] for robot_id in sorted(self._robots)])

    @property
    def known(self) -> dict[str, int]:
        """The ID of every named robot that has ever registered."""
        return dict(self._known)

    def get_robot(self, robot_id: int) -> Robot | None:
        return self._robots.get(robot_id)

    def add_robot(self, caller: str, now: float) -> Robot | None:
        """Register the robot whose client has the ROS name `caller`; None when all IDs are in use.

        A named robot that is still listed keeps its ID and its player, one that was here before gets its ID back.
        """
        lasting = _ROS_NAME.fullmatch(caller) and not _NAMELESS.fullmatch(caller)
        name = caller if lasting else None
        robot_id = self._get_available_id(name)
        if robot_id is None:
            return None
        robot = self._robots.setdefault(robot_id, Robot(robot_id, name, now))
        robot.alive_at = now
        if self._known.get(name or "") != robot_id:
            self._known = {known: kept for known, kept in self._known.items() if kept != robot_id}
            if name:
                self._known[name] = robot_id
        return robot

    def del_robot(self, robot: Robot) -> None:
        del self._robots[robot.id]

    def get_available_robot(self, wanted: int | None = None) -> Robot | None:
        """The robot with the ID `wanted`, or with the lowest ID, that nobody drives; None if there is none."""
        return next((robot for robot in self if robot.user is None and wanted in (None, robot.id)), None)

    def get_available_robots_n(self) -> int:
        return sum(robot.user is None for robot in self._robots.values())

    def _get_available_id(self, name: str | None) -> int | None:
        if name is not None:
            listed = next((robot.id for robot in self._robots.values() if robot.caller == name), None)
            if listed is not None:
                return listed
            kept = self._known.get(name)
            if kept is not None and kept not in self._robots:
                return kept
        free = [robot_id for robot_id in ROBOT_IDS if robot_id not in self._robots]
        reserved = set(self._known.values())
        # an ID kept for an absent robot is given away only when there is no other
        return next((robot_id for robot_id in free if robot_id not in reserved), free[0] if free else None)
