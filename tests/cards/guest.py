"""A player who turns a robot until he is ended: `python3 -m tests.cards.guest MASTER`, in the master's network."""

import sys
import time
from typing import NamedTuple

from tests.support.player import Player, players_and_free_robots
from tests.support.polling import until


class Front(NamedTuple):
    """A master's one address, a place to play at."""

    web: str
    bridge: str
    view: str = ""  # such as only virtual arenas have


def main() -> None:
    master = sys.argv[1]
    front = Front(f"http://{master}", f"ws://{master}/rosbridge")
    until(lambda: (players_and_free_robots(front) or ([], 0))[1] > 0, 300, "a robot is free")
    with Player(front, "Ada") as ada:
        print(f"turns robot {ada.robot}", flush=True)
        while True:
            ada.drive(angular=1)
            time.sleep(0.025)


if __name__ == "__main__":
    main()
