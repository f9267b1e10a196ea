"""Waits for the end of the battle, before something that it needs is restarted. New battles wait meanwhile.

    python3 -m laser_bot_battle.restarting http://MASTER:5000 --robot NAME     before that robot
    python3 -m laser_bot_battle.restarting http://localhost:5000               before a program of the master
    python3 -m laser_bot_battle.restarting http://MASTER:5000                  before anything else, which new battles
                                                                               do not wait for

It ends with 0 when the battle is over, when the robot is not in it, or when the server does not answer: then there is
no battle to wait for. A signal ends it at once.
"""

import argparse
import http.client
import json
import signal
import sys
import time
import urllib.parse
import urllib.request
from collections.abc import Callable

PERIOD = 1.0  # s
TIMEOUT = 2.0  # s for an answer
SILENT = 3.0  # s; the server has other things to do than to answer for a moment


def wait(
    ask: Callable[[], float | None],
    tell: Callable[[str], None],
    clock: Callable[[], float] = time.monotonic,
    rest: Callable[[float], None] = time.sleep,
) -> None:
    """Until `ask` says 0, or nothing (None) for `SILENT` s."""
    heard = clock()
    told = False
    while True:
        seconds, now = ask(), clock()
        if seconds is not None:
            heard = now
        elif now - heard >= SILENT:
            tell("the game's server does not answer: there is no battle to wait for")
            return
        if seconds == 0:
            return
        if seconds and not told:
            tell(f"waits for the end of the battle, {seconds:g} s at most")
            told = True
        rest(PERIOD)


def asking(url: str, robot: str) -> Callable[[], float | None]:
    """Asks the game's server at `url`; None without a sensible answer."""
    # it is in the LAN: no proxy
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    data = urllib.parse.urlencode({"robot": robot} if robot else {}).encode()

    def ask() -> float | None:
        try:
            with opener.open(f"{url.rstrip('/')}/restarting", data=data, timeout=TIMEOUT) as answer:
                return float(json.load(answer)["wait"])
        except (OSError, http.client.HTTPException, ValueError, KeyError, TypeError):
            return None

    return ask


def main() -> int:
    """The program; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="laser_bot_battle.restarting", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("url", help="of the game's pages")
    parser.add_argument("--robot", default="", help="its LASERBOT_ROBOT_NAME")
    given = parser.parse_args()
    if not given.url.startswith("http://"):
        parser.error(f"{given.url}: must be http://host:port")
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    wait(asking(given.url, given.robot), lambda text: print(f"laser_bot_battle.restarting: {text}", flush=True))
    return 0


if __name__ == "__main__":
    sys.exit(main())
