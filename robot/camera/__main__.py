"""The robot's camera: `python3 -m robot.camera` runs ustreamer and lets the master to its pictures (docs/cameras.md).

Ends with 0 on SIGINT or SIGTERM, with 1 when ustreamer ends or the port cannot be had, and with 2 for an impossible
setting: whoever started it starts it again.
"""

import argparse
import asyncio
import logging
import os
import shutil
import socket
import sys
import tempfile
import time
from pathlib import Path
from urllib.parse import urlsplit

from laser_bot_battle import variables
from laser_bot_battle.announcement import NoArenaError
from laser_bot_battle.child import run_child, until_signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.master import Master, MasterError
from laser_bot_battle.names import RELAY_NODE
from laser_bot_battle.place import locate
from laser_bot_battle.settings import describe, read_or_exit
from robot.camera.master_only import MasterOnly
from robot.camera.settings import LIBCAMERA, VARIABLES, CameraSettings, find_libcamera

_log = logging.getLogger(__name__)

PROGRAM = "robot.camera"
KNOWN_FOR = 5.0  # s that an address of the master is believed, and that a stranger does not make us ask again


class MasterAddresses:
    """Whose pictures they are: the addresses that the master and its relay have now, asked for again when somebody else
    comes. They may differ: a robot in a cluster knows the master by the address of a Service."""

    def __init__(self, environ: dict[str, str]) -> None:
        self._environ = environ
        self._arena = variables.ARENA_NAME.read(environ)
        self._addresses: set[str] = set()
        self._asked = float("-inf")
        self._asking = asyncio.Lock()

    async def has(self, address: str) -> bool:
        address = address.removeprefix("::ffff:")
        async with self._asking:
            if time.monotonic() - self._asked > KNOWN_FOR:
                await self._ask()
        return address in self._addresses

    async def _ask(self) -> None:
        try:
            place = await locate(self._environ, self._arena)
            loop = asyncio.get_running_loop()
            found = await loop.getaddrinfo(place.host, None, type=socket.SOCK_STREAM)
            self._addresses = {str(sockaddr[0]) for *_, sockaddr in found}
            self._addresses |= await asyncio.to_thread(_relays_addresses, place.ros_master_uri)
        except (OSError, NoArenaError) as error:
            _log.warning("the master is not found, so that nobody gets pictures: %s", error)
        self._asked = time.monotonic()


def _relays_addresses(ros_master_uri: str) -> set[str]:
    """Of the host on which the ROS master has the relay; none while it has none."""
    try:
        relay = Master(ros_master_uri, "camera").call("lookupNode", f"/{RELAY_NODE}")
        return {str(found[4][0]) for found in socket.getaddrinfo(urlsplit(relay).hostname, None, socket.AF_INET)}
    except (OSError, MasterError):
        return set()


async def run(settings: CameraSettings, environ: dict[str, str]) -> int:
    """Serve until SIGINT or SIGTERM (0), or until ustreamer ends (1)."""
    end = until_signalled()
    with tempfile.TemporaryDirectory(prefix="laserbot-camera-") as folder:
        at = Path(folder) / "ustreamer"
        door = MasterOnly(at, MasterAddresses(environ).has)
        try:
            await door.open(settings.port)
        except OSError as error:
            port, variable = settings.port, variables.CAMERA_PORT.name
            cure = f"stop the program that uses it, or set {variable}"
            _log.error("cannot listen on port %d: %s; %s", port, error.strerror, cure)
            return 1
        _log.info("camera %s: the master gets its pictures at port %d", settings.device or "(none)", settings.port)
        try:
            return await run_child(settings.command(at), end)
        finally:
            await door.close()


def main() -> int:
    argparse.ArgumentParser(
        prog=PROGRAM,
        description="Gives the master the pictures of this robot's camera, by ustreamer.",
        epilog=describe(*VARIABLES),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    ).parse_args()
    settings = read_or_exit(PROGRAM, CameraSettings.from_env)
    configure_logging(read_or_exit(PROGRAM, variables.LOG_LEVEL.read))
    if not shutil.which("ustreamer"):
        _log.error("ustreamer is not installed: apt-get install ustreamer")
        return 1
    if settings.device == LIBCAMERA and not find_libcamera():
        _log.error("libcamera is not installed for V4L2: apt-get install libcamera-v4l2 libcamera-ipa")
        return 1
    return asyncio.run(run(settings, dict(os.environ)))


if __name__ == "__main__":
    sys.exit(main())
