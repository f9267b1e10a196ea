"""rosbridge's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError
from server.node import NodeSettings

VARIABLES = (
    variables.BIND,
    variables.ROSBRIDGE,
    variables.OPERATOR_TOKEN,
    variables.OPERATOR_TOKEN_FILE,
    variables.LOG_LEVEL,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about rosbridge."""

    node: NodeSettings
    operator_token: str  # empty: nobody is an operator

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        return cls(
            node=NodeSettings.from_env(environ, variables.ROSBRIDGE),
            operator_token=_operator_token(environ),
        )


def _operator_token(environ: Mapping[str, str]) -> str:
    """The token itself or the contents of a file, which an environment does not show."""
    token, path = variables.OPERATOR_TOKEN.read(environ), variables.OPERATOR_TOKEN_FILE.read(environ)
    if not path:
        return token
    if token:
        raise SettingsError("LASERBOT_OPERATOR_TOKEN and LASERBOT_OPERATOR_TOKEN_FILE are both set: choose one")
    try:
        return Path(path).read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"LASERBOT_OPERATOR_TOKEN_FILE={path}: cannot be read: {error}") from None
