"""`python3 -m sim.arena`: the arena of the virtual robots."""

import argparse
import asyncio
import logging
import os
import sys

from aiohttp import web

from laser_bot_battle.floor_watch import another_floor
from laser_bot_battle.lifecycle import first_of, live_until, signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.open_files import allow_files
from laser_bot_battle.settings import describe, read_or_exit
from laser_bot_battle.watched import Owner, in_loop, watched
from sim.arena.ambient import Ambient, add_options
from sim.arena.cameras.pages import CameraPages
from sim.arena.link import MAX_CONNECTIONS, Link
from sim.arena.metrics import metrics
from sim.arena.overhead import conditions
from sim.arena.overhead.conditions import Conditions
from sim.arena.settings import VARIABLES, Settings
from sim.arena.view import View
from sim.arena.visits import ALL, Visits
from sim.arena.world import World

KEEP_ALIVE = 5.0  # s that a connection may wait for its next request
SPARE_FILES = 100  # beside sockets

_log = logging.getLogger(__name__)


async def run(settings: Settings, light: Ambient, timecode: bool, overhead: Conditions) -> bool:
    """Serve, in that light, until a signal, or until the floor is another one, and return whether it is. OSError if a
    port cannot be had."""
    end = signalled()
    world = World(settings.floor)
    link = Link(world, light)
    view = View(world, CameraPages(world, light, timecode, overhead), settings.proxies)
    page = web.AppRunner(view.app(), access_log=None, shutdown_timeout=1.0, keepalive_timeout=KEEP_ALIVE)
    await page.setup()
    assert page.server
    visits = Visits(page.server, settings.proxies)
    allow_files(ALL + MAX_CONNECTIONS + SPARE_FILES)
    try:
        await link.start(settings.bind, settings.link_port)
        await visits.start(settings.bind, settings.view_port)
        _log.info("arena at http://localhost:%d, robots connect to port %d", settings.view_port, settings.link_port)
        owner = Owner(lambda: metrics(world, view.viewers), lambda: "")
        with watched("arena", settings.metrics, in_loop(owner)):
            await first_of(live_until(end), another_floor(settings.floor_source, settings.floor))
        return not end.is_set()
    finally:
        await link.stop()
        visits.stop()
        await page.cleanup()


def main() -> int:
    """Exit code 0 after a signal, 1 if a port cannot be had, 2 for an impossible setting."""
    parser = argparse.ArgumentParser(
        "sim.arena",
        description="The physical world of the virtual robots: floor, walls, light.",
        epilog=describe(*VARIABLES),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_options(parser)
    conditions.add_options(parser)
    parser.add_argument("--timecode", action="store_true", help="what robots see carries its time, to measure delays")
    options = parser.parse_args()
    settings = read_or_exit("arena", Settings.from_env)
    configure_logging(settings.log_level)
    try:
        begins_anew = asyncio.run(run(settings, Ambient.of(options), options.timecode, Conditions.of(options)))
    except OSError as error:
        print(f"arena: cannot listen: {error.strerror}; is another arena running?", file=sys.stderr)
        return 1
    if begins_anew:
        _log.warning("the floor is another one: the arena begins anew")
        os.execv(sys.executable, sys.orig_argv)
    return 0


if __name__ == "__main__":
    sys.exit(main())
