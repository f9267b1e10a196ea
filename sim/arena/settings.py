"""The arena's settings, from environment variables."""

from collections.abc import Mapping
from dataclasses import dataclass

from laser_bot_battle.floor import Floor, read_floor
from laser_bot_battle.proxies import Network, believed
from laser_bot_battle.variables import (
    ALIVE_FILE,
    ARENA,
    ARENA_LINK,
    BIND,
    FLOOR,
    LOG_FORMAT,
    LOG_LEVEL,
    METRICS,
    PROXIES,
)

VARIABLES = (BIND, ARENA, ARENA_LINK, FLOOR, PROXIES, METRICS, LOG_LEVEL, LOG_FORMAT, ALIVE_FILE)


@dataclass(frozen=True)
class Settings:
    """Where the arena listens, its floor, and how much it logs."""

    bind: str
    view_port: int
    link_port: int
    floor: Floor
    floor_source: str  # its name, or the path of its file
    proxies: tuple[Network, ...]  # that are believed for whom they come
    metrics: tuple[str, int] | None  # where the first program is watched
    log_level: str

    @classmethod
    def from_env(cls, env: Mapping[str, str]) -> "Settings":
        """SettingsError for an impossible value, also in the floor's file."""
        return cls(
            bind=BIND.read(env),
            view_port=ARENA.read(env),
            link_port=ARENA_LINK.read(env),
            floor=read_floor(FLOOR.read(env)),
            floor_source=FLOOR.read(env),
            proxies=believed(env),
            metrics=METRICS.read(env),
            log_level=LOG_LEVEL.read(env),
        )
