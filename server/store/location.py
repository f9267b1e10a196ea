"""Where the database is."""

from collections.abc import Mapping
from pathlib import Path

from sqlalchemy import URL, make_url
from sqlalchemy.exc import ArgumentError

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError


def database_url(environ: Mapping[str, str]) -> URL:
    """Where the database is. SettingsError for an impossible value."""
    given = variables.DATABASE.read(environ)
    if not given:
        return URL.create("sqlite", database=str(data_folder(environ) / "laserbot.db"))
    try:
        url = make_url(given)
    except ArgumentError:
        raise SettingsError(f"LASERBOT_DATABASE: must be {variables.DATABASES}") from None
    if url.drivername == "postgresql":
        url = url.set(drivername="postgresql+pg8000")
    if url.drivername != "sqlite" and (others := url.query.keys() - {"unix_sock"}):
        raise SettingsError(f"LASERBOT_DATABASE has the option {', '.join(sorted(others))}: only unix_sock is known")
    return url


def data_folder(environ: Mapping[str, str]) -> Path:
    """Where the game keeps its files. SettingsError if it is in the home folder of a user who has none."""
    folder = variables.DATA.read(environ)
    try:
        return folder.expanduser()
    except RuntimeError:
        raise SettingsError(f"LASERBOT_DATA={folder}: this user has no home folder: give a full path") from None
