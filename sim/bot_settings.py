"""The bot's settings, from environment variables and arguments."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from laser_bot_battle.names import ROBOT_IDS
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.variables import ALIVE_FILE, ARENA, LOG_LEVEL, MASTER, ROSBRIDGE, WEB

VARIABLES = (MASTER, WEB, ROSBRIDGE, ARENA, LOG_LEVEL, ALIVE_FILE)
PREFIX = "Bot"  # a bot is called this and a number; players with other names are people
_NAME = re.compile(PREFIX + r"[0-9]{1,13}")  # at most 16 letters, like every player's


@dataclass(frozen=True)
class Settings:
    """Who the bot is and where the others are."""

    name: str
    robot: int | None  # the ID of the robot to drive, None for any
    web_url: str
    rosbridge_url: str
    view_url: str
    log_level: str

    @classmethod
    def read(
        cls,
        env: Mapping[str, str],
        *,
        name: str = "Bot1",
        master: str | None = None,
        rosbridge: str | None = None,
        arena: str | None = None,
        robot: str | None = None,
    ) -> "Settings":
        """`rosbridge` and `arena` are "host:port", or on the master. SettingsError for an impossible value."""
        if not is_bot(name):
            raise SettingsError(f"--name {name}: must be {PREFIX} and a number of up to 13 digits")
        if robot is not None and robot not in map(str, ROBOT_IDS):
            raise SettingsError(f"--robot {robot}: must be the ID of a robot, 0 to {max(ROBOT_IDS)}")
        host = master or MASTER.read(env)
        rosbridge = _place("--rosbridge", rosbridge) if rosbridge else f"{host}:{ROSBRIDGE.read(env)}"
        arena = _place("--arena", arena) if arena else f"{host}:{ARENA.read(env)}"
        return cls(
            name=name,
            robot=None if robot is None else int(robot),
            web_url=f"http://{host}:{WEB.read(env)}",
            rosbridge_url=f"ws://{rosbridge}",
            view_url=f"ws://{arena}/view",
            log_level=LOG_LEVEL.read(env),
        )


def _place(option: str, text: str) -> str:
    """`text` itself, which must be host:port."""
    host, _, port = text.rpartition(":")
    if not host:
        raise SettingsError(f"{option} {text}: must be HOST:PORT")
    try:
        WEB.parse(port)  # as every port
    except ValueError as error:
        raise SettingsError(f"{option} {text}: the port {error}") from None
    return text


def is_bot(name: str) -> bool:
    """Whether a player of this name is a bot: Bot1 is one, Botond is a person."""
    return _NAME.fullmatch(name) is not None


def following(name: str) -> str:
    """The bot's name to try when `name` is taken: Bot1 -> Bot2."""
    return f"{PREFIX}{int(name.removeprefix(PREFIX)) + 1}"
