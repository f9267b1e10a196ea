"""The process that makes what people look at. The game server starts it, on a socket that it listens on."""

import json
import logging
import os
import signal
import socket
import sys
import threading

import waitress

from laser_bot_battle.log import configure_logging
from laser_bot_battle.settings import read_or_exit
from server.pages.app import create_pages
from server.pages.audience import Audience, Ballot
from server.pages.kept import KeptAnswers
from server.store.results import Results
from server.web.lanes import THREADS, Lane
from server.web.settings import Settings

_NICE = 10  # the battle comes first


def main() -> None:
    """Serve on the socket whose file descriptor is the only argument, until the standard input ends."""
    settings = read_or_exit("server.pages", Settings.from_env, dict(os.environ))
    configure_logging(settings.program.log_level)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)  # sent to the game server too, which ends us
    os.nice(_NICE)
    audience = Audience()
    threading.Thread(target=_follow_the_game, args=[audience], name="follow the game", daemon=True).start()
    listener = socket.socket(fileno=int(sys.argv[1]))
    results = Results(settings.database)
    application = KeptAnswers(create_pages(settings, results, audience), results.mark)
    logging.getLogger("waitress.queue").setLevel(logging.ERROR)  # the game server has as many threads that ask
    waitress.create_server(application, sockets=[listener], threads=THREADS[Lane.PAGES], ident=None).run()


def _follow_the_game(audience: Audience) -> None:
    """It writes a line for each vote, and ends with us."""
    for line in sys.stdin.buffer:
        fields = json.loads(line)
        audience.open(Ballot(fields["number"], tuple(map(tuple, fields["choices"])), fields["ends_at"]))
    os._exit(0)


if __name__ == "__main__":
    main()
