"""The secret that makes an operator, of the web server and of rosbridge alike."""

from collections.abc import Mapping
from pathlib import Path

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError

SHORTEST = 16  # characters; fewer could be guessed, as nothing slows that down


def read_operator_token(environ: Mapping[str, str]) -> str:
    """The token itself or the contents of a file, which an environment does not show. "": nobody is an operator.

    SettingsError for a file that cannot be read, and for a token that is too short.
    """
    token, path = variables.OPERATOR_TOKEN.read(environ), variables.OPERATOR_TOKEN_FILE.read(environ)
    if token and path:
        raise SettingsError("LASERBOT_OPERATOR_TOKEN and LASERBOT_OPERATOR_TOKEN_FILE are both set: choose one")
    if path:
        try:
            token = Path(path).read_text().strip()
        except (OSError, UnicodeDecodeError) as error:
            raise SettingsError(f"LASERBOT_OPERATOR_TOKEN_FILE={path}: cannot be read: {error}") from None
    if 0 < len(token) < SHORTEST:
        where = f"LASERBOT_OPERATOR_TOKEN_FILE={path}" if path else "LASERBOT_OPERATOR_TOKEN"
        raise SettingsError(
            f"{where}: the token needs at least {SHORTEST} characters: make one by openssl rand -hex 16"
        )
    return token
