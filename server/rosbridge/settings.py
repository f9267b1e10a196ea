"""rosbridge's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from laser_bot_battle import variables
from laser_bot_battle.operator_token import read_operator_token
from laser_bot_battle.proxies import Network, believed
from laser_bot_battle.settings import Variable
from server.access.globs import Globs
from server.program.program import ProgramSettings

VARIABLES = (
    variables.BIND,
    variables.INTERFACE,
    variables.ROSBRIDGE,
    variables.OPERATOR_TOKEN,
    variables.OPERATOR_TOKEN_FILE,
    variables.OPEN,
    variables.TOPICS_GLOB,
    variables.SERVICES_GLOB,
    variables.PARAMS_GLOB,
    variables.WEB,
    variables.ORIGINS,
    variables.PROXIES,
    variables.PRIORITY,
    variables.METRICS,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


# What the command line can say instead of the environment.
OPTIONS: dict[str, Variable[Any]] = {
    "--port": variables.ROSBRIDGE,
    "--open": variables.OPEN,
    "--topics-glob": variables.TOPICS_GLOB,
    "--services-glob": variables.SERVICES_GLOB,
    "--params-glob": variables.PARAMS_GLOB,
}


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about rosbridge."""

    program: ProgramSettings
    operator_token: str  # empty: nobody is an operator
    is_open: bool  # everybody may do what an operator may
    globs: Globs
    web_port: int  # of the game's pages
    origins: tuple[str, ...]  # further addresses of them
    proxies: tuple[Network, ...]
    priority: int  # real-time, 0 for none

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        return cls(
            program=ProgramSettings.from_env(environ, variables.ROSBRIDGE),
            operator_token=read_operator_token(environ),
            is_open=variables.OPEN.read(environ),
            globs=Globs(
                variables.TOPICS_GLOB.read(environ),
                variables.SERVICES_GLOB.read(environ),
                variables.PARAMS_GLOB.read(environ),
            ),
            web_port=variables.WEB.read(environ),
            origins=variables.ORIGINS.read(environ),
            proxies=believed(environ),
            priority=variables.PRIORITY.read(environ),
        )
