"""Which robots are for bots: as configured, unless operators have decided otherwise. Pure.

A bot is a player like any other, who has a bot's name and makes room for people at once. What plays for it
(server.bots) signs it up when it hears from here that a robot is for one.
"""

from laser_bot_battle.names import is_bot
from laser_bot_battle.variables import BOT_LEVEL
from server.game.rules import Rules
from server.game.state import State
from server.game.users import User

LEVELS = BOT_LEVEL.words
NONE = ""  # in the place of a level: the robot is for people only


def bots(state: State, rules: Rules) -> dict[int, str]:
    """The bots' levels, by the robots that are for bots."""
    return {robot: level for robot, level in {**rules.bots, **state.bots}.items() if level != NONE}


def bot_on(state: State, robot_id: int) -> User | None:
    """The bot that drives that robot now."""
    return next((user for user in state.users if user.robot == robot_id and is_bot(user.name)), None)
