"""Reading LASERBOT_ variables: an impossible value gets one clear line, never a traceback."""

import logging
from collections.abc import Mapping


class SettingsError(ValueError):
    """A variable or argument with an impossible value; the text names it."""


def parse_port(text: str, name: str) -> int:
    """A TCP port, 1 to 65535; SettingsError, in which the port is called `name`."""
    if not (text.isascii() and text.isdigit() and 1 <= int(text) <= 65535):
        raise SettingsError(f"{name}={text}: must be a port, 1 to 65535")
    return int(text)


def read_port(env: Mapping[str, str], name: str, default: int) -> int:
    """A TCP port from the variable `name`; an empty variable counts as not set."""
    return parse_port(env.get(name) or str(default), name)


def read_log_level(env: Mapping[str, str]) -> str:
    """The level of LASERBOT_LOG_LEVEL as `logging` knows it; SettingsError."""
    text = env.get("LASERBOT_LOG_LEVEL") or "info"
    if text.upper() not in logging.getLevelNamesMapping():
        raise SettingsError(f"LASERBOT_LOG_LEVEL={text}: must be debug, info, warning or error")
    return text.upper()
