"""The entrance to several arenas: `python3 -m server.entrance`."""

import logging
import signal
import sys
import threading
import time
from contextlib import suppress
from types import FrameType

from waitress import wasyncore

from laser_bot_battle import alive, listening
from laser_bot_battle.listening import Listener
from laser_bot_battle.log import configure_logging
from laser_bot_battle.settings import read_or_exit
from server.entrance.app import create_entrance
from server.entrance.arenas import Arenas
from server.entrance.settings import VARIABLES, Settings
from server.entrance.watcher import Watcher
from server.program.program import read_arguments
from server.store.results import Results
from server.web.fair_server import FairServer
from server.web.lanes import Lane

PROGRAM = "python3 -m server.entrance"
_CLOSE_WITHIN = 0.5  # s

_log = logging.getLogger(__name__)


def main() -> int:
    """The program; returns its exit code."""
    description = "The entrance to several arenas: one page that leads players to a free robot of any."
    settings = read_or_exit(PROGRAM, Settings.from_env, read_arguments(PROGRAM, description, *VARIABLES))
    configure_logging(settings.log_level)
    if not settings.arenas:
        _log.warning("LASERBOT_ARENAS lists no arena: nobody can be led anywhere")
    elif not settings.domain:
        _log.warning("LASERBOT_DOMAIN is not set: arenas do not know the players whom the entrance sends")
    try:
        listener = listening.bind(settings.bind, settings.port)
    except OSError as error:
        _log.error(
            "cannot listen on %s port %d: %s; stop the program that uses it, or set LASERBOT_BIND or "
            "LASERBOT_ENTRANCE_PORT",
            settings.bind,
            settings.port,
            error.strerror or error,
        )
        return 1
    with listener:
        return _serve(settings, listener)


def _serve(settings: Settings, listener: Listener) -> int:
    """Until SIGINT or SIGTERM (0), or until a part ends by itself (1)."""
    ending = threading.Event()

    def end(_number: int, _frame: FrameType | None) -> None:
        ending.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    arenas = Arenas(settings.arenas)
    watcher = Watcher(settings.arenas, lambda name, seen: arenas.hear(name, seen, time.monotonic()))
    channels: dict[int, wasyncore.dispatcher] = {}
    results = Results(settings.database)
    application = create_entrance(settings, arenas, results)
    web = FairServer(application, listener, channels, _lane, settings.proxies)
    parts = [
        threading.Thread(target=web.run, name="web server", daemon=True),
        threading.Thread(target=watcher.run, name="watcher", daemon=True),
    ]
    for part in parts[: 2 if settings.arenas else 1]:
        part.start()
    _log.info("the entrance to %d arenas is at http://%s:%d", len(settings.arenas), settings.bind, settings.port)
    while not ending.wait(alive.PERIOD):
        ended = [part.name for part in parts if part.ident and not part.is_alive()]
        if ended:
            _log.error("the %s has ended: the program ends, for its supervisor to start it again", ended[0])
            return 1
        alive.touch()
    watcher.stop()
    with suppress(OSError):  # the loop was awake, and has closed the trigger before it was pulled
        web.trigger.pull_trigger(lambda: wasyncore.close_all(channels))  # in its thread: it may be accepting now
    parts[0].join(_CLOSE_WITHIN)
    results.close()
    return 0


def _lane(method: str, _path: str) -> Lane:
    """A crowd that looks never delays who wants to play."""
    return Lane.PAGES if method in ("GET", "HEAD") else Lane.PLAYERS


if __name__ == "__main__":
    sys.exit(main())
