"""`python3 -m server.bots`: bots for the robots that operators give them, real and virtual (docs/operator.md)."""

import argparse
import asyncio
import logging
import os
import sys

from laser_bot_battle.announcement import NoArenaError
from laser_bot_battle.lifecycle import live_until, signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import BOT_PREFIX
from laser_bot_battle.place import Place, locate
from laser_bot_battle.settings import describe, read_or_exit
from server.bots.bridge import RETRY
from server.bots.crew import Crew
from server.bots.settings import VARIABLES, Settings

PROGRAM = "python3 -m server.bots"
HELP = f"""\
Bots drive the robots that the operator gives them. A bot's name is {BOT_PREFIX} and a number, the first that is free.
It is ready while a person is ready, and sees the robots by the ROS topic /positions.

{describe(*VARIABLES)}
"""

_log = logging.getLogger(__name__)


async def play(settings: Settings) -> None:
    """Find the master and play there, until cancelled."""
    place = settings.place or await find_master(settings.arena)
    while True:
        _log.info("%s", place)
        place = await Crew(settings, place).run()


async def find_master(arena: str) -> Place:
    """Look until there is one, in the environment's ways."""
    told = ""
    while True:
        try:
            return await locate(os.environ, arena)
        except NoArenaError as error:
            if str(error) != told:
                _log.warning("%s; waiting", error)
            told = str(error)
        await asyncio.sleep(RETRY)


async def run(settings: Settings) -> None:
    """Play until SIGINT or SIGTERM."""
    end = signalled()
    async with asyncio.TaskGroup() as tasks:
        playing = tasks.create_task(play(settings))
        await live_until(end)
        playing.cancel()


def main() -> int:
    """Exit code 0 after a signal, 2 for an impossible setting."""
    parser = argparse.ArgumentParser(
        PROGRAM, description=__doc__, epilog=HELP, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--master", help="host of the web server (default: LASERBOT_MASTER, else it is looked for)")
    parser.add_argument("--rosbridge", metavar="HOST:PORT", help="rosbridge (default: on the master)")
    arguments = parser.parse_args()
    settings = read_or_exit(PROGRAM, lambda env: Settings.read(env, **vars(arguments)))
    configure_logging(settings.log_level)
    logging.getLogger("websockets").setLevel(logging.CRITICAL)  # what matters is told here
    asyncio.run(run(settings))
    return 0


if __name__ == "__main__":
    sys.exit(main())
