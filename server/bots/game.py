"""What a bot hears of the battle by rosbridge: `/game_status` and `/positions`, as JSON. Pure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from laser_bot_battle.geometry import Pose, Wall
from laser_bot_battle.names import Game, is_bot

MAX_SIDE = 100.0  # m, of a floor
OFF = 1.0  # m; a robot that is farther off the floor is none: to plan a way to it would take for ever
MOST_TURNED = 1e4  # rad
REFUSED = 2  # kind of a GameEvent: a hit that does not count


@dataclass(frozen=True)
class Player:
    """A signed-in player as /game_status shows it."""

    name: str
    robot: int
    life: int
    ready: bool


@dataclass(frozen=True)
class Status:
    """The battle's state: `game` is one of the constants in GameStatus.msg."""

    game: int
    players: tuple[Player, ...]
    paused: bool = False
    protection: float = 0.0  # s for which nobody can be hit
    hits: tuple[tuple[int, str], ...] = ()  # the last ones: their numbers, which grow, and who was hit

    @classmethod
    def from_message(cls, message: Mapping[str, Any]) -> "Status":
        """From a GameStatus as rosbridge sends it; KeyError, TypeError or ValueError if it is not one."""
        players = tuple(
            Player(str(user["name"]), int(user["robot"]), int(user["life"]), bool(user["ready"]))
            for user in message["users"]
        )
        hits = tuple(
            (int(event["number"]), str(event["name"])) for event in message["events"] if event["kind"] != REFUSED
        )
        protection = float(message.get("protection", 0))  # an older master knows none
        return cls(int(message["game"]), players, bool(message["paused"]), protection, hits)

    def player(self, name: str) -> Player | None:
        return next((player for player in self.players if player.name == name), None)


@dataclass(frozen=True)
class Floor:
    """What stays as it is in the arena."""

    width: float  # m
    height: float
    walls: tuple[Wall, ...]


@dataclass(frozen=True)
class Positions:
    """Where the robots are that can be seen, by their IDs."""

    floor: Floor
    robots: Mapping[int, Pose]

    @classmethod
    def from_message(cls, message: Mapping[str, Any]) -> "Positions":
        """From a Positions as rosbridge sends it, where numbers that are none are null; KeyError, TypeError or
        ValueError if it is not one, or of no floor."""
        width, height = float(message["width"]), float(message["height"])
        if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
            raise ValueError(f"a floor of {width:g} x {height:g} m")
        ends = iter([float(number) for number in message["walls"]])
        robots = {
            int(one["robot"]): Pose(float(one["x"]), float(one["y"]), float(one["heading"]))
            for one in message["robots"]
            if _is_between(one["x"], -OFF, width + OFF)
            and _is_between(one["y"], -OFF, height + OFF)
            and _is_between(one["heading"], -MOST_TURNED, MOST_TURNED)
        }
        return cls(Floor(width, height, tuple(zip(ends, ends, ends, ends, strict=False))), robots)


def _is_between(value: object, least: float, most: float) -> bool:
    """Whether it is a number, and one of these."""
    return isinstance(value, int | float) and least <= value <= most


def fights(status: Status, me: Player) -> bool:
    """Whether this player may drive in a battle now."""
    return status.game == Game.PLAYING and not status.paused and me.ready and me.life > 0


def wants_ready(status: Status) -> bool:
    """Whether a bot is ready to play: while a person is."""
    return any(player.ready and not is_bot(player.name) for player in status.players)
