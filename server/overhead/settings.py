"""The settings of the tracker."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self
from urllib.parse import urlsplit

from laser_bot_battle import variables
from laser_bot_battle.floor import Floor, read_floor
from laser_bot_battle.settings import SettingsError
from server.camera.stream import STREAM, Address
from server.program.program import ProgramSettings

VARIABLES = (
    variables.OVERHEAD_CAMERA,
    variables.OVERHEAD_HEIGHT,
    variables.OVERHEAD_TAG_HEIGHT,
    variables.FLOOR,
    variables.BIND,
    variables.INTERFACE,
    variables.METRICS,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
    variables.ROS_MASTER_URI,
)


@dataclass(frozen=True)
class Settings:
    """What an operator can choose about the camera above the floor."""

    program: ProgramSettings
    camera: Address | None  # None: nobody has said where it is
    camera_height: float  # m over the floor
    tag_height: float  # m, likewise, of robots' tags
    floor: Floor
    floor_source: str  # its name, or the path of its file

    @classmethod
    def from_env(cls, environ: Mapping[str, str]) -> Self:
        """Read `environ`. SettingsError for an impossible value."""
        url = variables.OVERHEAD_CAMERA.read(environ)
        return cls(
            program=ProgramSettings.from_env(environ),
            camera=stream_address(url) if url else None,
            camera_height=variables.OVERHEAD_HEIGHT.read(environ),
            tag_height=variables.OVERHEAD_TAG_HEIGHT.read(environ),
            floor=read_floor(variables.FLOOR.read(environ)),
            floor_source=variables.FLOOR.read(environ),
        )


def stream_address(url: str) -> Address:
    """Where the pictures come from; without a path, it is ustreamer's."""
    parts = urlsplit(url)
    target = parts.path + (f"?{parts.query}" if parts.query else "")
    try:
        port = parts.port or 80
    except ValueError:
        raise SettingsError(f"{variables.OVERHEAD_CAMERA.name}={url}: there is no such port") from None
    return Address(parts.hostname or "", port, STREAM if target in ("", "/") else target)
