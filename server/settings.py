"""The web server's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError
from server.game.referee import Rules
from server.node import NodeSettings

VARIABLES = (
    variables.BIND,
    variables.WEB,
    variables.ROSBRIDGE,
    variables.VIEW,
    variables.HIT_DAMAGE,
    variables.COUNTDOWN,
    variables.BATTLE_LIMIT,
    variables.PLAYER_TIMEOUT,
    variables.DATA,
    variables.ROSTER,
    variables.LOG_LEVEL,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the web server."""

    node: NodeSettings
    rosbridge_port: int
    view_port: int | None  # of an arena's view, on the host that serves the page; None: there is none to show
    data: Path
    roster: Mapping[str, int]  # IDs that the operator fixed, by the robots' ROS names
    rules: Rules

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        return cls(
            node=NodeSettings.from_env(environ, variables.WEB),
            rosbridge_port=variables.ROSBRIDGE.read(environ),
            view_port=variables.VIEW.read(environ),
            data=_expanded(variables.DATA.read(environ)),
            roster=variables.ROSTER.read(environ),
            rules=Rules(
                hit_damage=variables.HIT_DAMAGE.read(environ),
                countdown=variables.COUNTDOWN.read(environ),
                battle_limit=variables.BATTLE_LIMIT.read(environ),
                player_timeout=variables.PLAYER_TIMEOUT.read(environ),
            ),
        )


def _expanded(folder: Path) -> Path:
    try:
        return folder.expanduser()
    except RuntimeError:
        raise SettingsError(f"LASERBOT_DATA={folder}: this user has no home folder: give a full path") from None
