"""`python3 -m sim.arena`: the arena of the virtual robots."""

import argparse
import asyncio
import logging
import os
import signal
import sys

from aiohttp import web

from sim.arena.floor import BATTLE_FLOOR
from sim.arena.link import Link
from sim.arena.settings import Settings
from sim.arena.view import View
from sim.arena.world import World
from sim.environment import SettingsError

HELP = """\
variables:
  LASERBOT_BIND             address to listen at (0.0.0.0)
  LASERBOT_ARENA_PORT       HTTP: the arena seen from above (8080)
  LASERBOT_ARENA_LINK_PORT  TCP: the robots' hardware connects here (8081)
  LASERBOT_LOG_LEVEL        debug, info, warning or error (info)
"""

log = logging.getLogger("arena")


async def run(settings: Settings) -> None:
    """Serve until SIGINT or SIGTERM; OSError if a port cannot be had."""
    stop = asyncio.Event()
    for signum in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(signum, stop.set)
    world = World(BATTLE_FLOOR)
    link = Link(world)
    page = web.AppRunner(View(world).app(), access_log=None, shutdown_timeout=1.0)
    await page.setup()
    try:
        await link.start(settings.bind, settings.link_port)
        await web.TCPSite(page, settings.bind, settings.view_port).start()
        log.info("arena at http://localhost:%d, robots connect to port %d", settings.view_port, settings.link_port)
        await stop.wait()
    finally:
        await link.stop()
        await page.cleanup()


def main() -> int:
    """Exit code 0 after a signal, 1 if a port cannot be had, 2 for an impossible setting."""
    argparse.ArgumentParser(
        "sim.arena",
        description="The physical world of the virtual robots: floor, walls, light.",
        epilog=HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    ).parse_args()
    try:
        settings = Settings.from_env(os.environ)
    except SettingsError as error:
        print(f"arena: {error}", file=sys.stderr)
        return 2
    logging.basicConfig(level=settings.log_level, format="%(asctime)s %(name)s %(levelname)s %(message)s")
    try:
        asyncio.run(run(settings))
    except OSError as error:
        print(f"arena: cannot listen: {error.strerror}; is another arena running?", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
