"""The bot's configuration, from LASERBOT_ variables and arguments."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from sim.environment import SettingsError, parse_port, read_log_level, read_port

PREFIX = "Bot"  # a bot is called this and a number: it fights only when somebody plays who is called otherwise
_ROBOT = re.compile(r"[0-9]{1,3}")
_NAME = re.compile(PREFIX + r"[0-9]{1,13}")  # at most 16 letters, like every player's


@dataclass(frozen=True)
class Settings:
    """Who the bot is and where the others are."""

    name: str
    robot: int | None  # the ID of the robot to drive, None for any
    master: str
    web_port: int
    rosbridge_host: str
    rosbridge_port: int
    arena_host: str
    arena_port: int
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
        """`rosbridge` and `arena` are "host:port", or on the master.

        SettingsError if a value is impossible; an empty variable counts as not set.
        """
        if not is_bot(name):
            raise SettingsError(f"--name {name}: must be {PREFIX} and a number of up to 13 digits")
        if robot is not None and not _ROBOT.fullmatch(robot):
            raise SettingsError(f"--robot {robot}: must be the ID of a robot")
        master = master or env.get("LASERBOT_MASTER") or "laser_bot_master.local"
        rosbridge_host, rosbridge_port = _place(env, "--rosbridge", rosbridge, "LASERBOT_ROSBRIDGE_PORT", 9090)
        arena_host, arena_port = _place(env, "--arena", arena, "LASERBOT_ARENA_PORT", 8080)
        return cls(
            name=name,
            robot=None if robot is None else int(robot),
            master=master,
            web_port=read_port(env, "LASERBOT_WEB_PORT", 5000),
            rosbridge_host=rosbridge_host or master,
            rosbridge_port=rosbridge_port,
            arena_host=arena_host or master,
            arena_port=arena_port,
            log_level=read_log_level(env),
        )

    @property
    def web_url(self) -> str:
        return f"http://{self.master}:{self.web_port}"

    @property
    def rosbridge_url(self) -> str:
        return f"ws://{self.rosbridge_host}:{self.rosbridge_port}"

    @property
    def view_url(self) -> str:
        return f"ws://{self.arena_host}:{self.arena_port}/view"


def _place(env: Mapping[str, str], option: str, text: str | None, variable: str, default: int) -> tuple[str, int]:
    """Host (empty: the master) and port of a service."""
    if not text:
        return "", read_port(env, variable, default)
    host, _, port = text.rpartition(":")
    if not host:
        raise SettingsError(f"{option} {text}: must be HOST:PORT")
    return host, parse_port(port, f"{option} port")


def is_bot(name: str) -> bool:
    """Whether a player of this name is a bot: Bot1 is one, Botond is a person."""
    return _NAME.fullmatch(name) is not None


def following(name: str) -> str:
    """The bot's name to try when `name` is taken: Bot1 -> Bot2."""
    return f"{PREFIX}{int(name.removeprefix(PREFIX)) + 1}"
