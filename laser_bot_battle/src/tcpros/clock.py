"""ROS's time: the wall's, or a simulation's /clock (wiki.ros.org/Clock)."""

import logging
import struct
import time

import genpy
from rosgraph_msgs.msg import Clock as ClockMessage

from laser_bot_battle.master import MasterError
from tcpros.node import Node
from tcpros.specs import TypeSpec

_log = logging.getLogger(__name__)

_TIME = struct.Struct("<II")  # s, ns
CLOCK = TypeSpec.of(ClockMessage)


class Clock:
    """Wall time until it is simulated."""

    def __init__(self) -> None:
        self._simulated: int | None = None

    def nanoseconds(self) -> int:
        return time.time_ns() if self._simulated is None else self._simulated

    def now(self) -> genpy.Time:
        return genpy.Time(0, self.nanoseconds())

    def simulate(self, nanoseconds: int) -> None:
        self._simulated = nanoseconds


async def clock_of(node: Node) -> Clock:
    """With the parameter /use_sim_time the clock follows /clock, and stands at 0 until that comes, as rospy's does."""
    clock = Clock()
    try:
        simulated = await node.master("getParam", "/use_sim_time")
    except MasterError:  # it is not set
        simulated = False
    except OSError as error:
        _log.warning("the ROS master does not say whether /use_sim_time is set, so wall time is used: %s", error)
        simulated = False
    if simulated:
        clock.simulate(0)

        def tick(data: bytes, _: object) -> None:
            seconds, nanoseconds = _TIME.unpack(data)
            clock.simulate(seconds * 10**9 + nanoseconds)

        node.subscribe("/clock", CLOCK, tick)
        _log.info("time is that of /clock: /use_sim_time is set")
    return clock
