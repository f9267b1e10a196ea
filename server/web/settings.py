"""The web server's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, Self

from sqlalchemy import URL

from laser_bot_battle import variables
from laser_bot_battle.floor import Floor, read_floor
from laser_bot_battle.operator_token import read_operator_token
from laser_bot_battle.proxies import Network, believed
from laser_bot_battle.settings import Variable
from server.game.rules import DECLARED, Rules
from server.program.program import ProgramSettings
from server.store.location import data_folder, database_url

VARIABLES: tuple[Variable[Any], ...] = (
    variables.BIND,
    variables.INTERFACE,
    variables.WEB,
    variables.ROSBRIDGE,
    variables.RELAY,
    variables.ORIGINS,
    variables.DOMAIN,
    variables.PROXIES,
    *DECLARED.values(),
    variables.FLOOR,
    variables.BOT_ROBOTS,
    variables.BOT_LEVEL,
    variables.OPERATOR_TOKEN,
    variables.OPERATOR_TOKEN_FILE,
    variables.DATA,
    variables.DATABASE,
    variables.ARENA_NAME,
    variables.ROSTER,
    variables.JOURNAL,
    variables.METRICS,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


class PageSettings(Protocol):
    """What every program with pages must know of its surroundings."""

    @property
    def rosbridge_port(self) -> int: ...  # 0: its pages open no WebSocket
    @property
    def relay_port(self) -> int: ...
    @property
    def origins(self) -> tuple[str, ...]: ...
    @property
    def domain(self) -> str: ...
    @property
    def proxies(self) -> tuple[Network, ...]: ...


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the web server."""

    program: ProgramSettings
    rosbridge_port: int
    relay_port: int  # of the cameras' pictures
    origins: tuple[str, ...]  # further addresses of the pages
    domain: str  # of arenas that share their players' sessions; "": this one shares nothing
    proxies: tuple[Network, ...]
    data: Path
    database: URL
    arena: str  # whose data these are, where several arenas share the database; "": a file, which is never shared
    roster: Mapping[str, int]  # IDs that the operator fixed, by the robots' ROS names
    rules: Rules
    floor: Floor
    floor_source: str  # its name, or the path of its file
    operator_token: str  # empty: nobody is an operator
    journal: Path | None  # folder of systemd's journals that operators may read

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        database, arena = database_url(environ), variables.ARENA_NAME.read(environ)
        journal = variables.JOURNAL.read(environ)
        bots = dict.fromkeys(variables.BOT_ROBOTS.read(environ), variables.BOT_LEVEL.read(environ))
        return cls(
            program=ProgramSettings.from_env(environ, variables.WEB),
            rosbridge_port=variables.ROSBRIDGE.read(environ),
            relay_port=variables.RELAY.read(environ),
            origins=variables.ORIGINS.read(environ),
            domain=variables.DOMAIN.read(environ),
            proxies=believed(environ),
            data=data_folder(environ),
            database=database,
            arena="" if database.drivername == "sqlite" else arena,
            roster=variables.ROSTER.read(environ),
            rules=Rules(**{name: variable.read(environ) for name, variable in DECLARED.items()}, bots=bots),
            floor=read_floor(variables.FLOOR.read(environ)),
            floor_source=variables.FLOOR.read(environ),
            operator_token=read_operator_token(environ),
            journal=Path(journal) if journal else None,
        )
