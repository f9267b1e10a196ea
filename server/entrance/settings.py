"""The entrance's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

from sqlalchemy import URL

from laser_bot_battle import variables
from laser_bot_battle.arena_list import ListedArena
from laser_bot_battle.proxies import Network, believed
from server.store.location import database_url

VARIABLES = (
    variables.BIND,
    variables.ENTRANCE,
    variables.ARENAS,
    variables.DOMAIN,
    variables.ORIGINS,
    variables.PROXIES,
    variables.DATA,
    variables.DATABASE,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
)


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the entrance. It is server.web.settings.PageSettings, too."""

    bind: str
    port: int
    arenas: tuple[ListedArena, ...]
    domain: str  # that they share with the entrance
    origins: tuple[str, ...]
    proxies: tuple[Network, ...]
    database: URL  # for the results
    log_level: str
    # its pages open no WebSocket
    rosbridge_port: int = 0
    relay_port: int = 0

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        return cls(
            bind=variables.BIND.read(environ),
            port=variables.ENTRANCE.read(environ),
            arenas=variables.ARENAS.read(environ),
            domain=variables.DOMAIN.read(environ),
            origins=variables.ORIGINS.read(environ),
            proxies=believed(environ),
            database=database_url(environ),
            log_level=variables.LOG_LEVEL.read(environ),
        )
