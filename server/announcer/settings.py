"""The announcer's settings."""

import socket
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self
from urllib.parse import urlsplit

from laser_bot_battle import variables
from laser_bot_battle.addresses import check_interface
from laser_bot_battle.announcement import shortened
from laser_bot_battle.names import ROS_PORT

VARIABLES = (
    variables.ARENA_NAME,
    variables.BIND,
    variables.INTERFACE,
    variables.WEB,
    variables.ROSBRIDGE,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the announcement: the arena's name, and where the master's programs listen."""

    arena: str
    bind: str
    web: int
    rosbridge: int
    ros: int
    log_level: str

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        check_interface(environ)
        return cls(
            arena=variables.ARENA_NAME.read(environ) or host_arena(socket.gethostname()),
            bind=variables.BIND.read(environ),
            web=variables.WEB.read(environ),
            rosbridge=variables.ROSBRIDGE.read(environ),
            ros=urlsplit(variables.ROS_MASTER_URI.read(environ)).port or ROS_PORT,
            log_level=variables.LOG_LEVEL.read(environ),
        )


def host_arena(host: str) -> str:
    """The name of the arena on the machine `host`, unless it was given one."""
    return shortened(host.partition(".")[0]) or "LaserBot"
