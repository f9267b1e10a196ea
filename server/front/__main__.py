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

from laser_bot_battle.child import run_child, until_signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.settings import read_or_exit
from server.front.configuration import configuration
from server.front.settings import VARIABLES, FrontSettings
from server.program.program import read_arguments

PROGRAM = "python3 -m server.front"
NGINX = "/usr/sbin/nginx"

_log = logging.getLogger(__name__)


async def run(settings: FrontSettings) -> int:
    """Serve until SIGINT or SIGTERM (0), or until nginx ends (1)."""
    end = until_signalled()
    known = _times(settings)
    with tempfile.TemporaryDirectory(prefix="laserbot-front-") as folder:
        os.chmod(folder, 0o711)  # nginx's workers are nobody special
        # nginx's workers may not see into the folder where the game is
        shutil.copyfile(Path(__file__).with_name("trust.html"), Path(folder) / "trust.html")
        _offer_authority(settings, Path(folder))
        file = Path(folder) / "nginx.conf"
        try:
            file.write_text(configuration(settings, Path(folder), is_root=os.geteuid() == 0))
        except OSError as error:
            _log.error("cannot listen on %s: %s; set LASERBOT_BIND", settings.bind, error.strerror or error)
            return 1
        _log.info("the game is at port %d", settings.https_port if settings.certificate else settings.http_port)

        def look(nginx: asyncio.subprocess.Process) -> None:
            nonlocal known
            if known != (newest := _times(settings)):
                known = newest
                _log.info("the certificate is another one: it is read again")
                _offer_authority(settings, Path(folder))
                nginx.send_signal(signal.SIGHUP)

        return await run_child([NGINX, "-p", folder, "-e", "stderr", "-c", file], end, look)


def _offer_authority(settings: FrontSettings, folder: Path) -> None:
    """nginx's workers have no rights of their own, and give visitors what the operator's folder may hide from them."""
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
