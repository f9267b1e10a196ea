"""Everybody's log lines on one topic: `python3 -m server.ros.rosout`, the ROS node `rosout`.

As the rosout that roscore starts: what nodes publish on /rosout it publishes on /rosout_agg, for rqt_console and the
like. Unlike that one it writes no file, and what waits for a slow reader is bounded. No battle needs it: whatever
becomes of it, only log lines are lost.
"""

import sys

from rosgraph_msgs.msg import Log

from laser_bot_battle import variables
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import ROSOUT_NODE
from laser_bot_battle.settings import read_or_exit
from server.program.event_loop import live, ros_node, work_in_loop
from server.program.program import Program, ProgramSettings, read_arguments
from tcpros.specs import TypeSpec

FROM, TO = "/rosout", "/rosout_agg"
VARIABLES = (
    variables.BIND,
    variables.INTERFACE,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


def main() -> int:
    """The program; returns its exit code."""
    command = "python3 -m server.ros.rosout"
    environment = read_arguments(
        command, "Passes the log lines of all nodes on, from /rosout to /rosout_agg.", *VARIABLES
    )
    settings = read_or_exit(command, ProgramSettings.from_env, environment)
    configure_logging(settings.log_level)
    program = Program(ROSOUT_NODE, settings)
    return program.run_without_port(lambda: work_in_loop(program, "rosout", lambda: _pass_on(program)))


async def _pass_on(program: Program) -> None:
    """The messages stay as they are, so none is unpacked."""
    spec = TypeSpec.of(Log)
    async with ros_node(program, ROSOUT_NODE) as node:
        everybody = node.advertise(TO, spec)
        node.subscribe(FROM, spec, lambda message, _: everybody.publish(message))
        await live(program)


if __name__ == "__main__":
    sys.exit(main())
