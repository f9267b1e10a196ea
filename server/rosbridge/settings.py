"""rosbridge's settings: environment variables, read once."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

LOG_LEVELS = ("debug", "info", "warning", "error")


class SettingsError(ValueError):
    """A variable has an impossible value; the text names it and what is allowed."""


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about rosbridge."""

    bind: str = "0.0.0.0"
    port: int = 9090
    operator_token: str = ""  # empty: nobody is an operator
    master_uri: str = "http://localhost:11311"
    log_level: str = "info"

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`; an unset or empty variable means the default. SettingsError for an impossible value."""
        port = environ.get("LASERBOT_ROSBRIDGE_PORT") or str(cls.port)
        if not (port.isascii() and port.isdigit() and 1 <= int(port) <= 65535):
            raise SettingsError(f"LASERBOT_ROSBRIDGE_PORT={port}: must be a whole number from 1 to 65535")
        log_level = (environ.get("LASERBOT_LOG_LEVEL") or cls.log_level).lower()
        if log_level not in LOG_LEVELS:
            raise SettingsError(f"LASERBOT_LOG_LEVEL={log_level}: must be one of {', '.join(LOG_LEVELS)}")
        return cls(
            bind=environ.get("LASERBOT_BIND") or cls.bind,
            port=int(port),
            operator_token=_operator_token(environ),
            master_uri=environ.get("ROS_MASTER_URI") or cls.master_uri,
            log_level=log_level,
        )


def _operator_token(environ: Mapping[str, str]) -> str:
    """The token itself or the contents of a file, which an environment does not show; empty: none."""
    token, path = environ.get("LASERBOT_OPERATOR_TOKEN") or "", environ.get("LASERBOT_OPERATOR_TOKEN_FILE")
    if not path:
        return token
    if token:
        raise SettingsError("LASERBOT_OPERATOR_TOKEN and LASERBOT_OPERATOR_TOKEN_FILE are both set: choose one")
    try:
        return Path(path).read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"LASERBOT_OPERATOR_TOKEN_FILE={path}: cannot be read: {error}") from None
