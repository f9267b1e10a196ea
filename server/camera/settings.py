"""The relay's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

from laser_bot_battle import variables
from laser_bot_battle.operator_token import read_operator_token
from laser_bot_battle.proxies import Network, believed
from server.program.program import ProgramSettings

VARIABLES = (
    variables.BIND,
    variables.INTERFACE,
    variables.RELAY,
    variables.RELAY_VIEWERS,
    variables.RELAY_RATE,
    variables.OPERATOR_TOKEN,
    variables.OPERATOR_TOKEN_FILE,
    variables.WEB,
    variables.ORIGINS,
    variables.PROXIES,
    variables.METRICS,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the cameras' relay."""

    program: ProgramSettings
    viewers: int  # at most, at once
    rate: int  # Mbit/s of all pictures
    operator_token: str  # empty: nobody is an operator
    web_port: int  # of the game's pages
    origins: tuple[str, ...]  # further addresses of them
    proxies: tuple[Network, ...]

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        return cls(
            program=ProgramSettings.from_env(environ, variables.RELAY),
            viewers=variables.RELAY_VIEWERS.read(environ),
            rate=variables.RELAY_RATE.read(environ),
            operator_token=read_operator_token(environ),
            web_port=variables.WEB.read(environ),
            origins=variables.ORIGINS.read(environ),
            proxies=believed(environ),
        )
