"""The registered robots (manual 3.1.5): a plain registry without locks, owned by the referee."""

import hmac
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from laser_bot_battle.names import ROBOT_IDS, key_digest

_ROS_NAME = re.compile(r"/[A-Za-z][A-Za-z0-9_/]{0,254}")
# what ROS calls nodes that gave no name: rospy without init_node, and anonymous nodes (name_pid_milliseconds)
_NAMELESS = re.compile(r"/unnamed|.*_\d+_\d{13}")

# s; a robot cannot report hits faster: MIN_HIT_INTERVAL_MS of firmware/laserbot/src/ir/hit_detector.h
HIT_INTERVAL = 0.1
_JITTER = 0.05  # s that the network may take longer for one hit than for the next


@dataclass
class Robot:
    """A robot that answers. `caller` is the ROS name of its client, None if it has no lasting one."""

    id: int
    caller: str | None
    alive_at: float  # monotonic seconds of the last registration or ping
    user: str | None = None
    in_service: bool = True
    key: str = ""  # SHA-256 (hex) of what its pings show; "" if it has none, as original robots
    address: str = ""  # from which it registered, "" if that is not known
    linked: bool = False  # its serial node is on the topics: it can be driven and hit
    next_hit: float = 0.0  # when the next hit is due at the earliest
    spared_until: float = -math.inf  # it may be silent till then

    @property
    def is_free(self) -> bool:
        """Whether it can be given to a player."""
        return self.user is None and self.in_service and self.linked

    def is_ping(self, key: str, address: str) -> bool:
        """Whether a ping that shows `key` and comes from `address` is this robot's."""
        if self.key:
            return hmac.compare_digest(key_digest(key), self.key)
        return self.address in ("", address)

    def can_be_hit(self, now: float) -> bool:
        """Whether a hit that is reported now can be one."""
        return now >= self.next_hit - _JITTER

    def note_hit(self, now: float) -> None:
        self.next_hit = max(self.next_hit, now) + HIT_INTERVAL


class Robots:
    """The robots by ID, and the IDs that are kept for named robots that were here before."""

    def __init__(self, known: Mapping[str, int] | None = None) -> None:
        self._robots: dict[int, Robot] = {}
        self._known = dict(known or {})
        self._out: set[int] = set()

    def __iter__(self) -> Iterator[Robot]:
        """The robots in the order of their IDs."""
        return iter([self._robots[robot_id] for robot_id in sorted(self._robots)])

    @property
    def known(self) -> dict[str, int]:
        """The ID of every named robot that has ever been on its topics."""
        return dict(self._known)

    def remember(self, known: Mapping[str, int]) -> None:
        """The IDs that robots had in an earlier program, unless they have others now."""
        taken = set(self._known.values()) | self._robots.keys()
        self._known |= {name: robot for name, robot in known.items() if name not in self._known and robot not in taken}

    @property
    def out_of_service(self) -> frozenset[int]:
        """IDs, also of robots that are not here now."""
        return frozenset(self._out)

    def get_robot(self, robot_id: int) -> Robot | None:
        return self._robots.get(robot_id)

    def id_for(self, caller: str) -> tuple[int | None, str | None]:
        """The ID for the robot whose client has the ROS name `caller`, None when there is none left; and that name,
        None if it will not last.

        A named robot that is still listed keeps its ID and its player, one that was here before gets its ID back. That
        ID is not for others while it is away.
        """
        lasting = _ROS_NAME.fullmatch(caller) and not _NAMELESS.fullmatch(caller)
        name = caller if lasting else None
        return self._get_available_id(name), name

    def put(self, robot_id: int, name: str | None, now: float, key: str = "", address: str = "") -> Robot:
        """List the robot, or note that it has come back. `key` is the digest."""
        robot = self._robots.setdefault(robot_id, Robot(robot_id, name, now, in_service=robot_id not in self._out))
        robot.alive_at, robot.key, robot.address = now, key, address
        return robot

    def link(self, robot_id: int, linked: bool) -> None:
        """The robot's serial node is on the topics, or is not. It is remembered from then on: a name alone is not a
        robot, and costs nothing."""
        robot = self._robots[robot_id]
        robot.linked = linked
        if linked and self._known.get(robot.caller or "") != robot_id:
            self._known = {known: kept for known, kept in self._known.items() if kept != robot_id}
            if robot.caller:
                self._known[robot.caller] = robot_id

    def note_hit(self, robot_id: int, now: float) -> None:
        self._robots[robot_id].note_hit(now)

    def set_service(self, robot_id: int, in_service: bool) -> None:
        """It holds for the ID, whether its robot is here or not."""
        if in_service:
            self._out.discard(robot_id)
        else:
            self._out.add(robot_id)
        robot = self._robots.get(robot_id)
        if robot is not None:
            robot.in_service = in_service

    def del_robot(self, robot_id: int) -> None:
        del self._robots[robot_id]

    def get_available_robots(self) -> list[Robot]:
        """The robots that are free, in the order of their IDs."""
        return [robot for robot in self if robot.is_free]

    def _get_available_id(self, name: str | None) -> int | None:
        if name is not None:
            listed = next((robot.id for robot in self._robots.values() if robot.caller == name), None)
            if listed is not None:
                return listed
            kept = self._known.get(name)
            if kept is not None and kept not in self._robots:
                return kept
        taken = {*self._robots, *self._known.values()}
        return next((robot_id for robot_id in ROBOT_IDS if robot_id not in taken), None)
