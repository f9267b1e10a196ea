"""A battle under way, for faults to happen in."""

import math

from tests.support.player import Eyes, Player
from tests.support.polling import until

STOPPED, COUNTDOWN, PLAYING = 0, 1, 2


def start(*players: Player) -> None:
    for player in players:
        assert player.ready() == "OK"
    for player in players:
        player.wait_for_game(PLAYING)


def obeys(player: Player, eyes: Eyes, seconds: float = 30.0) -> None:
    """Wait until the player's robot turns on command."""
    heading = eyes.robots()[player.robot]["heading"]

    def turned() -> bool:
        player.drive(angular=1)
        return abs(math.remainder(eyes.robots()[player.robot]["heading"] - heading, math.tau)) > 0.2

    until(turned, seconds, f"robot {player.robot} obeys {player.name}")
    player.drive()


def stands_still(player: Player, eyes: Eyes, seconds: float = 5.0) -> None:
    seen: list[float] = []

    def still() -> bool:
        seen.append(eyes.robots()[player.robot]["heading"])
        return len(seen) > 50 and len(set(seen[-50:])) == 1

    until(still, seconds, f"robot {player.robot} stands still")
