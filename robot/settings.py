"""Configuration of the robot's programs: environment variables, read once."""

import socket
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from laser_bot_battle import variables
from laser_bot_battle.addresses import check_interface
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import client_name
from laser_bot_battle.place import Place
from laser_bot_battle.settings import read_or_exit


@dataclass(frozen=True)
class Settings:
    place: Place | None  # of the master; None if the robot is to find it
    arena: str  # the name of the one to join, "" for the only one
    devices: tuple[str, ...]  # where the Arduino may be, best first: paths or pyserial URLs
    caller_id: str  # the ROS name under which this robot asks for its ID
    retry: float  # s between attempts, at most
    led: int | None  # GPIO of the status LED, None if the robot has none
    priority: int  # real-time, 0 for none
    camera: str  # "" if the robot has none
    camera_port: int  # on this robot, of its pictures
    camera_url: str  # where they are instead, or ""
    log_level: str

    @classmethod
    def from_env(cls, env: Mapping[str, str]) -> "Settings":
        """SettingsError names the variable whose value cannot be used."""
        check_interface(env)
        return cls(
            place=Place.given(env),
            arena=variables.ARENA_NAME.read(env),
            devices=variables.SERIAL.read(env),
            caller_id=client_name(variables.ROBOT_NAME.read(env) or default_robot_name()),
            retry=variables.RETRY.read(env),
            led=variables.LED.read(env),
            priority=variables.PRIORITY.read(env),
            camera=variables.CAMERA.read(env),
            camera_port=variables.CAMERA_PORT.read(env),
            camera_url=variables.CAMERA_URL.read(env),
            log_level=variables.LOG_LEVEL.read(env),
        )

    @classmethod
    def load(cls, program: str) -> "Settings":
        """Those of this process, with logging set up; a wrong value ends the program with exit code 2."""
        settings = read_or_exit(program, cls.from_env)
        configure_logging(settings.log_level)
        return settings


def default_robot_name(interfaces: Path = Path("/sys/class/net")) -> str:
    """Host name and MAC address: the same at each boot, different on each robot of a cloned SD card."""
    addresses = {path.parent: path.read_text().strip() for path in sorted(interfaces.glob("*/address"))}
    usable = [path for path, address in addresses.items() if address.strip("0:")]
    # hardware before bridges and tunnels, which come and go; inside a container there may be no hardware
    best = min(usable, key=lambda path: (not (path / "device").exists(), path.name), default=None)
    return "_".join([socket.gethostname(), *([addresses[best]] if best else [])])
