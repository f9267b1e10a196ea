"""The secret that makes an operator, of the web server and of rosbridge alike."""

from collections.abc import Mapping
from pathlib import Path

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError, trimmed


def check_choice(environ: Mapping[str, str]) -> None:
    """SettingsError if both the token and a file with it are given."""
    both = (variables.OPERATOR_TOKEN.name, variables.OPERATOR_TOKEN_FILE.name)
    if all(trimmed(environ.get(name, "")) for name in both):
        raise SettingsError(f"{both[0]} and {both[1]} are both set: choose one")


def read_operator_token(environ: Mapping[str, str]) -> str:
    """The token itself or the contents of a file, which an environment does not show. "": nobody is an operator.

    SettingsError for a file that cannot be read, and for a token that is too short.
    """
    check_choice(environ)
    path = variables.OPERATOR_TOKEN_FILE.read(environ)
    if not path:
        return variables.OPERATOR_TOKEN.read(environ)
    try:
        token = Path(path).read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"LASERBOT_OPERATOR_TOKEN_FILE={path}: cannot be read: {error}") from None
    try:
        return variables.OPERATOR_TOKEN.parse(token) if token else ""
    except ValueError as error:
        raise SettingsError(f"LASERBOT_OPERATOR_TOKEN_FILE={path}: {error}") from None
