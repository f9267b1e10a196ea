"""The numbers of the game."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, TypeVar

from laser_bot_battle import variables
from laser_bot_battle.settings import Variable

T = TypeVar("T")


def _chosen(variable: Variable[T]) -> T:
    """The field of a rule that this variable sets."""
    default: T = field(default=variable.default, metadata={"variable": variable})
    return default


@dataclass(frozen=True)
class Rules:
    """Times in seconds."""

    hit_damage: int = _chosen(variables.HIT_DAMAGE)
    light: str = _chosen(variables.LIGHT)  # plain or coded
    teams: int = _chosen(variables.TEAMS)  # 0: everybody fights alone
    friendly_fire: bool = _chosen(variables.FRIENDLY_FIRE)
    light_damage: bool = _chosen(variables.LIGHT_DAMAGE)  # a coded hit takes what its code says
    hide_cameras: bool = _chosen(variables.HIDE_CAMERAS)  # from spectators, while a battle runs
    handicap: int = _chosen(variables.HANDICAP)  # percent of damage that hits spare whoever has lost several in a row
    countdown: float = _chosen(variables.COUNTDOWN)
    battle_limit: float = _chosen(variables.BATTLE_LIMIT)
    protection: float = _chosen(variables.PROTECTION)  # from the start of a battle: nobody can be hit
    player_timeout: float = _chosen(variables.PLAYER_TIMEOUT)  # a fighter's page that is silent for so long has gone
    seat_timeout: float = _chosen(variables.SEAT_TIMEOUT)  # any other player's
    idle: float = _chosen(variables.IDLE)  # without being ready while others wait
    offer: float = _chosen(variables.OFFER)  # to take a robot that is offered
    battles_in_row: int = _chosen(variables.BATTLES_IN_ROW)  # while others wait; 0: as many as one likes
    seat_minutes: float = _chosen(variables.SEAT_MINUTES)  # likewise, of one seat
    seats: int = _chosen(variables.SEATS)  # robots that are given to players at once; 0: all
    practice: bool = _chosen(variables.PRACTICE)  # driving without a battle
    practice_beside: bool = _chosen(variables.PRACTICE_BESIDE)  # driving while others fight
    late_join: bool = _chosen(variables.LATE_JOIN)  # joining a battle that runs
    fence: bool = _chosen(variables.FENCE)  # robots stop at the floor's edge
    hill: bool = _chosen(variables.HILL)  # seconds alone on a hill are points, and decide the battle
    pickups: float = _chosen(variables.PICKUPS)  # after which something lies at each of its places; 0: nothing does
    line_of_fire: float = _chosen(variables.LINE_OF_FIRE)  # m that a robot's light reaches; 0: hits count from anywhere
    bots: Mapping[int, str] = field(default_factory=dict)  # their levels, by robot (server.game.bots)
    robot_timeout: float = 3.0  # within the 2 to 4 s of the manual's sweep
    robot_return: float = 10.0  # a robot's program that starts again needs 5 to 8

    @property
    def is_coded(self) -> bool:
        """Whether the light tells who has shot."""
        return self.light == "coded"


# the rules that can be chosen, by name, with the variables that set them and know their bounds
DECLARED: Mapping[str, Variable[Any]] = {
    rule.name: rule.metadata["variable"] for rule in fields(Rules) if "variable" in rule.metadata
}


def checked(rule: str, value: object) -> Any:
    """`value`, as JSON has it, as a value of that rule. ValueError says what is allowed."""
    variable = DECLARED[rule]
    if variable.is_flag:
        if isinstance(value, bool):
            return value
        raise ValueError(f"{rule} must be true or false")
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    text = str(value) if is_number or (variable.words and isinstance(value, str)) else "none"
    try:
        return variable.parse(text)
    except ValueError as error:
        raise ValueError(f"{rule} {error}") from None
