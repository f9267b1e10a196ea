"""What players do in a battle, wherever it is played: in processes, containers, pods, on hosts."""

import contextlib
import math
import threading
from collections.abc import Iterator
from typing import Protocol

from websockets.exceptions import WebSocketException

from tests.support.player import Eyes, Hunter, Place, Player, players_and_free_robots
from tests.support.polling import until

STOPPED, COUNTDOWN, PLAYING = 0, 1, 2


def start(*players: Player) -> None:
    for player in players:
        assert player.ready() == "OK"
    for player in players:
        player.wait_for_game(PLAYING)


def a_bot_waits(battle: Place) -> bool:
    """Whether it is the only player, and a robot is free for another one."""
    players, free = players_and_free_robots(battle) or ([], 0)
    return [name for name, _ in players] == ["Bot1"] and free == 1


def reconnect(player: Player, seconds: float = 30.0) -> None:
    def connected() -> bool:
        with contextlib.suppress(OSError, WebSocketException):
            player.connect()
            return True
        return False

    until(connected, seconds, f"{player.name}'s page finds rosbridge again")


def obeys(player: Player, eyes: Eyes, seconds: float = 30.0) -> None:
    """Wait until the player's robot turns on command."""
    heading = eyes.robots()[player.robot]["heading"]

    def turned() -> bool:
        player.drive(angular=1)
        return abs(math.remainder(eyes.robots()[player.robot]["heading"] - heading, math.tau)) > 0.2

    until(turned, seconds, f"robot {player.robot} obeys {player.name}")
    player.drive()


@contextlib.contextmanager
def keep_turning(*players: Player) -> Iterator[None]:
    """As pages whose players hold a key: 40 commands/s each, as long as their connections last."""
    released = threading.Event()

    def hold() -> None:
        with contextlib.suppress(WebSocketException, OSError):
            while not released.wait(0.025):
                for player in players:
                    player.drive(angular=1)

    thread = threading.Thread(target=hold)
    thread.start()
    try:
        yield
    finally:
        released.set()
        thread.join()


def stands_still(player: Player, eyes: Eyes, seconds: float = 5.0) -> None:
    seen: list[float] = []

    def still() -> bool:
        seen.append(eyes.robots()[player.robot]["heading"])
        return len(seen) > 50 and len(set(seen[-50:])) == 1

    until(still, seconds, f"robot {player.robot} stands still")


class Prey(Protocol):
    """Somebody who is shot at: a Player, or a person at a browser."""

    name: str
    robot: int


def hunt_down(shooter: Player, target: Prey, eyes: Eyes, life: int, seconds: float = 60.0) -> None:
    """Hunt the target until it has `life` left."""
    hunter = Hunter(eyes.floor)

    def wounded() -> bool:
        shooter.drive(*hunter.command(eyes.robots(), shooter.robot, target.robot))
        return int(shooter.user(target.name)["life"]) <= life

    until(wounded, seconds, f"{shooter.name} shoots {target.name} down to {life}")
    shooter.drive()


def shoot_to_the_end(shooter: Player, target: Player | int, eyes: Eyes, seconds: float = 120.0) -> list[int]:
    """Hunt the target (a player, or the robot of one that is not ours) until the battle is over.

    The lives that everybody saw of a player, each once.
    """
    prey = target if isinstance(target, int) else target.robot
    hunter = Hunter(eyes.floor)
    lives: list[int] = []

    def over() -> bool:
        shooter.drive(*hunter.command(eyes.robots(), shooter.robot, prey))
        life = shooter.user(target.name).get("life") if isinstance(target, Player) else None
        if life is not None and life not in lives:
            lives.append(life)
        return bool(shooter.look()["game"] == STOPPED)

    until(over, seconds, f"{shooter.name} shoots robot {prey} to the end")
    return lives
