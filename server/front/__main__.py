"""One address for all of the game: `python3 -m server.front` writes nginx's configuration and runs it."""

import asyncio
import logging
import os
import shutil
import signal
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from laser_bot_battle import alive
from laser_bot_battle.log import configure_logging
from laser_bot_battle.settings import read_or_exit
from server.front.configuration import configuration
from server.front.settings import VARIABLES, FrontSettings
from server.node import read_arguments

PROGRAM = "python3 -m server.front"
STOP_SECONDS = 2.0
NGINX = "/usr/sbin/nginx"

_log = logging.getLogger(__name__)


async def run(settings: FrontSettings) -> int:
    """Serve until SIGINT or SIGTERM (0), or until nginx ends (1)."""
    end = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, end.set)
    with tempfile.TemporaryDirectory(prefix="laserbot-front-") as folder:
        os.chmod(folder, 0o711)  # nginx's workers are nobody special
        _offer_authority(settings, Path(folder))
        file = Path(folder) / "nginx.conf"
        file.write_text(configuration(settings, Path(folder), is_root=os.geteuid() == 0))
        nginx = await asyncio.create_subprocess_exec(NGINX, "-p", folder, "-e", "stderr", "-c", file, process_group=0)
        _log.info("the game is at port %d", settings.https_port if settings.certificate else settings.http_port)
        try:
            return await _watch(nginx, settings, Path(folder), end)
        finally:
            await _stop(nginx)


async def _watch(nginx: asyncio.subprocess.Process, settings: FrontSettings, folder: Path, end: asyncio.Event) -> int:
    """nginx is told when the certificate has been renewed."""
    ended = asyncio.create_task(nginx.wait())
    ordered = asyncio.create_task(end.wait())
    certificate = _times(settings)
    try:
        while not ended.done() and not ordered.done():
            alive.touch()
            await asyncio.wait([ended, ordered], timeout=alive.PERIOD, return_when=asyncio.FIRST_COMPLETED)
            if certificate != (newest := _times(settings)) and not ended.done():
                certificate = newest
                _log.info("the certificate is another one: it is read again")
                _offer_authority(settings, folder)
                nginx.send_signal(signal.SIGHUP)
        if ordered.done():
            return 0
        _log.error("nginx has ended (%s): the program ends, for its supervisor to start it again", ended.result())
        return 1
    finally:
        ended.cancel()
        ordered.cancel()


def _offer_authority(settings: FrontSettings, folder: Path) -> None:
    """nginx's workers, who are nobody special, give visitors what the operator's own folder may hide."""
    if settings.certificate and settings.certificate.authority:
        with suppress(OSError):  # it is just being replaced
            shutil.copyfile(settings.certificate.authority, folder / "ca.crt")


def _times(settings: FrontSettings) -> list[int]:
    """When the certificate's files were written; those that are just being replaced are missing."""
    files = settings.certificate.files if settings.certificate else ()
    times = []
    for file in files:
        with suppress(OSError):
            times.append(file.stat().st_mtime_ns)
    return times


async def _stop(nginx: asyncio.subprocess.Process) -> None:
    if nginx.returncode is not None:
        return
    nginx.terminate()
    try:
        await asyncio.wait_for(nginx.wait(), STOP_SECONDS)
    except TimeoutError:
        nginx.kill()
        await nginx.wait()


def main() -> int:
    """The program; returns its exit code."""
    description = "One address for the game's pages, rosbridge, cameras and arena, with or without TLS, by nginx."
    environment = read_arguments(PROGRAM, description, *VARIABLES)
    settings = read_or_exit(PROGRAM, FrontSettings.from_env, environment)
    configure_logging(settings.log_level)
    if not shutil.which(NGINX):
        _log.error("nginx is not installed: apt-get install nginx-light")
        return 1
    return asyncio.run(run(settings))


if __name__ == "__main__":
    sys.exit(main())
