"""The secret that makes an operator, of the web server and of rosbridge alike."""

from collections.abc import Mapping
from pathlib import Path

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError


def read_operator_token(environ: Mapping[str, str]) -> str:
    """The token itself or the contents of a file, which an environment does not show. "": nobody is an operator."""
    token, path = variables.OPERATOR_TOKEN.read(environ), variables.OPERATOR_TOKEN_FILE.read(environ)
    if not path:
        return token
    if token:
        raise SettingsError("LASERBOT_OPERATOR_TOKEN and LASERBOT_OPERATOR_TOKEN_FILE are both set: choose one")
    try:
        return Path(path).read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"LASERBOT_OPERATOR_TOKEN_FILE={path}: cannot be read: {error}") from None
