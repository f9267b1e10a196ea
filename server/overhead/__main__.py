"""The camera above the floor: `python3 -m server.overhead`, the ROS node `overhead_tracker`.

`python3 -m server.overhead tags` writes the tags to print.
"""

import asyncio
import logging
import sys

from laser_bot_battle.apriltag import AprilTagError
from laser_bot_battle.floor_watch import another_floor
from laser_bot_battle.lifecycle import first_of
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import OVERHEAD_NODE
from laser_bot_battle.settings import read_or_exit
from laser_bot_battle.variables import OVERHEAD_CAMERA
from laser_bot_battle.watched import Owner, in_loop, watched
from server.overhead import print_tags
from server.overhead.eye import Eye, Looker
from server.overhead.program import OverheadProgram
from server.overhead.settings import VARIABLES, Settings
from server.program.event_loop import live, ros_node, warn_of_arguments, work_in_loop
from server.program.program import Program, read_arguments

COMMAND = "python3 -m server.overhead"

_log = logging.getLogger(__name__)


def main() -> int:
    """The program; returns its exit code."""
    if sys.argv[1:2] == ["tags"]:
        return print_tags.main(f"{COMMAND} tags", sys.argv[2:])
    description = f"Tracks the robots with a camera above the floor. '{COMMAND} tags' writes the tags to print."
    settings = read_or_exit(COMMAND, Settings.from_env, read_arguments(COMMAND, description, *VARIABLES))
    configure_logging(settings.program.log_level)
    if settings.camera is None:
        _log.error("%s must say where the camera above the floor is: http://host:port", OVERHEAD_CAMERA.name)
        return 2
    eye = Eye(settings.camera)
    warn_of_arguments(OVERHEAD_NODE)
    try:
        looker = Looker()
    except AprilTagError as error:
        _log.error("%s", error)
        return 1
    program = Program(OVERHEAD_NODE, settings.program)
    return program.run_without_port(
        lambda: work_in_loop(program, "tracker", lambda: _track(program, settings, eye, looker))
    )


async def _track(program: Program, settings: Settings, eye: Eye, looker: Looker) -> None:
    async with ros_node(program, OVERHEAD_NODE) as node:
        overhead = OverheadProgram(node, settings, eye, looker)
        with watched("overhead", settings.program.metrics, in_loop(Owner(overhead.metrics, overhead.missing))):
            async with asyncio.TaskGroup() as tasks:
                work = tasks.create_task(overhead.run())
                await first_of(live(program), another_floor(settings.floor_source, settings.floor))
                program.begin_anew("the floor is another one")
                work.cancel()


if __name__ == "__main__":
    sys.exit(main())
