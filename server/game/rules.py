"""The numbers of the game."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from laser_bot_battle import variables
from laser_bot_battle.settings import Variable


@dataclass(frozen=True)
class Rules:
    """Times in seconds."""

    hit_damage: int = variables.HIT_DAMAGE.default
    light: str = variables.LIGHT.default  # plain or coded
    teams: int = variables.TEAMS.default  # 0: everybody fights alone
    friendly_fire: bool = variables.FRIENDLY_FIRE.default
    light_damage: bool = variables.LIGHT_DAMAGE.default  # a coded hit takes what its code says
    hide_cameras: bool = variables.HIDE_CAMERAS.default  # from spectators, while a battle runs
    countdown: float = variables.COUNTDOWN.default
    battle_limit: float = variables.BATTLE_LIMIT.default
    player_timeout: float = variables.PLAYER_TIMEOUT.default  # a fighter's page that is silent for so long has gone
    seat_timeout: float = variables.SEAT_TIMEOUT.default  # any other player's
    idle: float = variables.IDLE.default  # without being ready while others wait
    offer: float = variables.OFFER.default  # to take a robot that is offered
    battles_in_row: int = variables.BATTLES_IN_ROW.default  # while others wait; 0: as many as one likes
    seats: int = variables.SEATS.default  # robots that are given to players at once; 0: all
    practice: bool = variables.PRACTICE.default  # driving without a battle
    robot_timeout: float = 3.0  # within the 2 to 4 s of the manual's sweep
    robot_return: float = 10.0  # a robot's program that starts again needs 5 to 8

    @property
    def is_coded(self) -> bool:
        """Whether the light tells who has shot."""
        return self.light == "coded"


# the rules that can be chosen, by the variables that set them and know their bounds
DECLARED: Mapping[str, Variable[Any]] = {
    "hit_damage": variables.HIT_DAMAGE,
    "light": variables.LIGHT,
    "teams": variables.TEAMS,
    "friendly_fire": variables.FRIENDLY_FIRE,
    "light_damage": variables.LIGHT_DAMAGE,
    "hide_cameras": variables.HIDE_CAMERAS,
    "countdown": variables.COUNTDOWN,
    "battle_limit": variables.BATTLE_LIMIT,
    "player_timeout": variables.PLAYER_TIMEOUT,
    "seat_timeout": variables.SEAT_TIMEOUT,
    "idle": variables.IDLE,
    "offer": variables.OFFER,
    "battles_in_row": variables.BATTLES_IN_ROW,
    "seats": variables.SEATS,
    "practice": variables.PRACTICE,
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
