"""A player who turns a robot until the program is stopped: `python3 -m tests.cards.guest MASTER`, in its network."""

import sys
import time

from tests.support.player import Front, Player, players_and_free_robots
from tests.support.polling import until


def main() -> None:
    front = Front(sys.argv[1])
    until(lambda: (players_and_free_robots(front) or ([], 0))[1] > 1, 300, "two robots are free")
    with Player(front, "Ada") as ada:
        print(f"turns robot {ada.robot}", flush=True)
        while True:
            ada.drive(angular=1)
            time.sleep(0.025)


if __name__ == "__main__":
    main()
