"""Lists the arenas that announce themselves in this network, and what is wrong with them.

    python3 -m robot.find

Needs no ROS. Exit code 0 if a robot could join one of them, else 1.
"""

import argparse
import asyncio
import re
import signal
import sys
import time

from robot.installed import missing_explained

with missing_explained():
    from laser_bot_battle.addresses import check_interface
    from laser_bot_battle.announcement import Announcement, arena_of
    from laser_bot_battle.master_probe import is_master
    from laser_bot_battle.search import MAX_ARENAS, Search, searching
    from laser_bot_battle.settings import read_or_exit

PROGRAM = "robot.find"
POLL = 0.1  # s
LONGEST = 3600.0  # s
ADVICE = """\
No robot could join an arena from here. Check:
  - Does the master's announcer run (python3 -m server.announcer; with compose the service announcer)?
  - Are both machines in the same network? Multicast passes no router, and no guest network.
  - Do the firewalls let UDP port 5353 pass, and the ROS master's TCP port?
  - The networks of containers and pods pass no multicast: set LASERBOT_MASTER to the master's address there.\
"""


def main() -> int:
    parser = argparse.ArgumentParser(
        prog=PROGRAM, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=seconds, default=3.0, help="how long to listen (default %(default)g)")
    arguments = parser.parse_args()
    read_or_exit(PROGRAM, check_interface)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return asyncio.run(find(arguments.seconds))
    except KeyboardInterrupt:
        return 128 + signal.SIGINT


def seconds(text: str) -> float:
    if re.fullmatch(r"[0-9]{1,4}(\.[0-9]{1,3})?", text) and 0 < float(text) <= LONGEST:
        return float(text)
    raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds up to {LONGEST:g}")


async def find(listen: float) -> int:
    """Listen, and print what is there; returns the exit code."""
    print(f"Listening for {listen:g} s ...", flush=True)
    try:
        async with searching() as search:
            end = time.monotonic() + listen
            while time.monotonic() < end and not search.is_flooded():
                await asyncio.sleep(min(POLL, listen))
            usable = [await show(arena) for arena in sorted(search.all(), key=lambda arena: arena.arena)]
            show_refused(search)
    except OSError as error:
        print(f"Nothing can be heard here: {error}.")
        usable = []
    if not any(usable):
        print(ADVICE)
    return 0 if any(usable) else 1


async def show(arena: Announcement) -> bool:
    """Print one arena; whether a ROS master answers there."""
    answers = await asyncio.gather(*(is_master(address, arena.ros) for address in arena.addresses))
    print(f"arena {arena.arena!r}, version {arena.version}")
    for address, answered in zip(arena.addresses, answers, strict=True):
        print(f"  {address:15}  {'its ROS master answers' if answered else 'no ROS master answers'}")
    print(f"  ports: web {arena.web}, rosbridge {arena.rosbridge}, ROS {arena.ros}")
    return any(answers)


def show_refused(search: Search) -> None:
    for name, reason in sorted(search.refused.items()):
        print(f"passed over: {arena_of(name)!r}, because {reason}")
    if search.ignored:
        print(f"passed over: everything beyond {MAX_ARENAS} arenas")


if __name__ == "__main__":
    sys.exit(main())
