"""The web server's settings: LASERBOT_ environment variables, read once."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from server.referee import Rules
from server.roster import parse_fixed

LOG_LEVELS = ("debug", "info", "warning", "error")


class SettingsError(ValueError):
    """A variable has an impossible value; the text names it and what is allowed."""


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the web server."""

    bind: str = "0.0.0.0"
    web_port: int = 5000
    rosbridge_port: int = 9090
    view_port: int | None = None  # of an arena's view, on the host that serves the page; None: there is none to show
    master_uri: str = "http://localhost:11311"
    data: Path = Path("~/.local/share/laserbot")
    roster: Mapping[str, int] = field(default_factory=dict)  # IDs that the operator fixed, by the robots' ROS names
    log_level: str = "info"
    rules: Rules = field(default_factory=Rules)

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`; an unset or empty variable means the default. SettingsError for an impossible value."""
        rules = Rules(
            hit_damage=int(_number(environ, "LASERBOT_HIT_DAMAGE", Rules.hit_damage, 1, 100, whole=True)),
            countdown=_number(environ, "LASERBOT_COUNTDOWN", Rules.countdown, 0.1, 3600),
            battle_limit=_number(environ, "LASERBOT_BATTLE_LIMIT", Rules.battle_limit, 1, 86400),
            player_timeout=_number(environ, "LASERBOT_PLAYER_TIMEOUT", Rules.player_timeout, 1, 86400),
        )
        log_level = (environ.get("LASERBOT_LOG_LEVEL") or cls.log_level).lower()
        if log_level not in LOG_LEVELS:
            raise SettingsError(f"LASERBOT_LOG_LEVEL={log_level}: must be one of {', '.join(LOG_LEVELS)}")
        return cls(
            bind=environ.get("LASERBOT_BIND") or cls.bind,
            web_port=int(_number(environ, "LASERBOT_WEB_PORT", cls.web_port, 1, 65535, whole=True)),
            rosbridge_port=int(_number(environ, "LASERBOT_ROSBRIDGE_PORT", cls.rosbridge_port, 1, 65535, whole=True)),
            view_port=int(_number(environ, "LASERBOT_VIEW_PORT", 0, 1, 65535, whole=True)) or None,
            master_uri=environ.get("ROS_MASTER_URI") or cls.master_uri,
            data=_folder(environ.get("LASERBOT_DATA") or cls.data),
            roster=_roster(environ.get("LASERBOT_ROSTER") or ""),
            log_level=log_level,
            rules=rules,
        )


def _number(
    environ: Mapping[str, str], name: str, default: float, lowest: float, highest: float, *, whole: bool = False
) -> float:
    text = environ.get(name)
    if not text:
        return default
    try:
        value = float(int(text)) if whole else float(text)
    except (ValueError, OverflowError):
        value = math.nan
    if not lowest <= value <= highest:
        kind = "a whole number" if whole else "a number"
        raise SettingsError(f"{name}={text}: must be {kind} from {lowest:g} to {highest:g}")
    return value


def _roster(text: str) -> dict[str, int]:
    try:
        return parse_fixed(text)
    except ValueError as error:
        raise SettingsError(f"LASERBOT_ROSTER={text}: {error}") from None


def _folder(path: str | Path) -> Path:
    try:
        return Path(path).expanduser()
    except RuntimeError:
        raise SettingsError(f"LASERBOT_DATA={path}: this user has no home folder, so set it to another one") from None
