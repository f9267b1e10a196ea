"""The arena's configuration, from LASERBOT_ variables."""

from collections.abc import Mapping
from dataclasses import dataclass

from sim.environment import read_log_level, read_port


@dataclass(frozen=True)
class Settings:
    """Where the arena listens and how much it logs."""

    bind: str
    view_port: int
    link_port: int
    log_level: str

    @classmethod
    def from_env(cls, env: Mapping[str, str]) -> "Settings":
        """SettingsError if a value is impossible. An empty variable counts as not set."""
        return cls(
            bind=env.get("LASERBOT_BIND") or "0.0.0.0",
            view_port=read_port(env, "LASERBOT_ARENA_PORT", 8080),
            link_port=read_port(env, "LASERBOT_ARENA_LINK_PORT", 8081),
            log_level=read_log_level(env),
        )
