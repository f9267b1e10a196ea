"""`python3 -m sim.positions`: tells ROS where the virtual robots are, as an overhead camera would: `/positions`.

It only watches the arena's public view, on this machine. Ends with 1 when the ROS master is lost: whoever started it
starts it again.
"""

import argparse
import asyncio
import logging
import os
import sys
from typing import NoReturn

import aiohttp
import rospy

from laser_bot_battle.geometry import Pose
from laser_bot_battle.lifecycle import first_of, live_until, signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.master import Master, MasterWatch
from laser_bot_battle.msg import Positions, RobotPosition
from laser_bot_battle.names import POSITIONS, POSITIONS_NODE
from laser_bot_battle.ros_environment import ros_environment
from laser_bot_battle.rospy_cures import cure_rospy
from laser_bot_battle.settings import describe, read_or_exit
from laser_bot_battle.variables import ALIVE_FILE, ARENA, LOG_LEVEL, ROS_MASTER_URI
from sim.bot_game import Arena, Eyes

VARIABLES = (ROS_MASTER_URI, ARENA, LOG_LEVEL, ALIVE_FILE)
PERIOD = 1 / 15  # s between two messages: pages draw what moves from them

_log = logging.getLogger(__name__)


def to_message(arena: Arena, robots: dict[int, Pose]) -> Positions:
    return Positions(
        width=arena.width,
        height=arena.height,
        walls=[number for wall in arena.walls for number in wall],
        robots=[RobotPosition(number, pose.x, pose.y, pose.heading) for number, pose in robots.items()],
    )


async def publish(eyes: Eyes) -> NoReturn:
    """For ever, while the arena can be seen and somebody listens."""
    publisher = rospy.Publisher(POSITIONS, Positions, queue_size=1)
    while True:
        if eyes.arena and eyes.can_see and publisher.get_num_connections():
            publisher.publish(to_message(eyes.arena, eyes.robots()))
        await asyncio.sleep(PERIOD)


async def run(master_uri: str, view: str) -> int:
    """Work until SIGINT or SIGTERM, or until the master is lost; returns the exit code."""
    end, loop = signalled(), asyncio.get_running_loop()
    lost: list[str] = []

    def on_lost(reason: str) -> None:
        lost.append(reason)
        loop.call_soon_threadsafe(end.set)

    watch = MasterWatch(Master(master_uri, POSITIONS_NODE), on_lost)
    try:
        os.environ.update(ros_environment(os.environ, master_uri))
        watch.start()  # rospy would wait for an absent master for ever
        cure_rospy()
        rospy.init_node(POSITIONS_NODE, disable_signals=True, disable_rosout=True)
        async with aiohttp.ClientSession() as http:
            eyes = Eyes(http, view)
            await first_of(eyes.watch(), publish(eyes), live_until(end))
    except (OSError, rospy.ROSException) as error:
        lost.append(f"ROS master {master_uri}: {error}")
    finally:
        watch.stop()
        rospy.signal_shutdown("the program ends")
    if lost:
        _log.error("%s", lost[0])
    return 1 if lost else 0


def main() -> int:
    """Exit code 0 after a signal, 1 when the ROS master is lost, 2 for an impossible setting."""
    argparse.ArgumentParser(
        "sim.positions",
        description="Tells ROS where the virtual robots are.",
        epilog=describe(*VARIABLES),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    ).parse_args()
    master_uri, port, log_level = read_or_exit(
        "positions", lambda env: (ROS_MASTER_URI.read(env), ARENA.read(env), LOG_LEVEL.read(env))
    )
    configure_logging(log_level)
    return asyncio.run(run(master_uri, f"ws://127.0.0.1:{port}/view"))


if __name__ == "__main__":
    sys.exit(main())
