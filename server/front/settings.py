"""The front's settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError

VARIABLES = (
    variables.BIND,
    variables.HTTP,
    variables.HTTPS,
    variables.TLS,
    variables.WEB,
    variables.ROSBRIDGE,
    variables.RELAY,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
)


@dataclass(frozen=True)
class Certificate:
    """For TLS: files in PEM."""

    chain: Path
    key: Path
    authority: Path | None  # of the fleet's own, which visitors have to trust first

    @property
    def files(self) -> tuple[Path, ...]:
        return self.chain, self.key, *([self.authority] if self.authority else [])


@dataclass(frozen=True)
class FrontSettings:
    """Where visitors come, and where the programs are that answer them, on this machine."""

    bind: str
    http_port: int
    https_port: int
    certificate: Certificate | None  # None: without TLS
    web_port: int
    rosbridge_port: int
    relay_port: int
    log_level: str

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        return cls(
            bind=variables.BIND.read(environ),
            http_port=variables.HTTP.read(environ),
            https_port=variables.HTTPS.read(environ),
            certificate=_certificate(environ),
            web_port=variables.WEB.read(environ),
            rosbridge_port=variables.ROSBRIDGE.read(environ),
            relay_port=variables.RELAY.read(environ),
            log_level=variables.LOG_LEVEL.read(environ),
        )


def _certificate(environ: Mapping[str, str]) -> Certificate | None:
    given = variables.TLS.read(environ)
    if not given:
        return None
    chain, key, authority = (Path(given) / name for name in ("front.crt", "front.key", "ca.crt"))
    try:
        here = [file for file in (chain, key, authority) if file.exists()]
        for file in here:
            file.read_bytes()
    except OSError as error:
        raise SettingsError(
            f"{variables.TLS.name}={given}: {error.filename} cannot be read: {error.strerror}"
        ) from None
    if not here:
        return None
    if not {chain, key} <= {*here}:
        raise SettingsError(f"{variables.TLS.name}={given}: front.crt and front.key belong together")
    return Certificate(chain, key, authority if authority in here else None)
