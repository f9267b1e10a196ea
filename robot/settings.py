"""Configuration of the robot's programs: environment variables, read once."""

import logging
import re
import socket
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

DEVICES = ("/dev/laserbot", "/dev/ttyACM0", "/dev/ttyUSB0")
HEADER_GPIOS = range(28)  # the others belong to the Raspberry Pi's own parts, such as its SD card
LOG_LEVELS = ("debug", "info", "warning", "error")


@dataclass(frozen=True)
class Settings:
    master: str  # host of the web server
    web_port: int
    ros_master_uri: str
    devices: tuple[str, ...]  # where the Arduino may be, best first: paths or pyserial URLs
    robot_name: str  # stable identity of this robot
    retry: float  # s between attempts
    led: int | None  # GPIO of the status LED, None if the robot has none
    log_level: str

    @classmethod
    def from_env(cls, env: Mapping[str, str]) -> "Settings":
        """ValueError names the variable whose value cannot be used."""
        master = env.get("LASERBOT_MASTER") or "laser_bot_master.local"
        devices = (env.get("LASERBOT_SERIAL") or "").split()
        level = (env.get("LASERBOT_LOG_LEVEL") or "info").lower()
        if level not in LOG_LEVELS:
            raise ValueError(f"LASERBOT_LOG_LEVEL={level}: must be one of {', '.join(LOG_LEVELS)}")
        web_port = _number(env, "LASERBOT_WEB_PORT", 5000, (1, 65535))
        if web_port != int(web_port):
            raise ValueError(f"LASERBOT_WEB_PORT={web_port:g}: must be a whole number")
        return cls(
            master=master,
            web_port=int(web_port),
            ros_master_uri=_master_uri(env.get("ROS_MASTER_URI") or f"http://{master}:11311"),
            devices=tuple(devices) or DEVICES,
            robot_name=env.get("LASERBOT_ROBOT_NAME") or default_robot_name(),
            retry=_number(env, "LASERBOT_RETRY", 5, (0.1, 3600)),
            led=_led(env),
            log_level=level,
        )

    @classmethod
    def load(cls, env: Mapping[str, str]) -> "Settings":
        """As from_env, and sets up logging; a wrong value ends the program with exit code 2."""
        try:
            settings = cls.from_env(env)
        except ValueError as error:
            print(error, file=sys.stderr)
            raise SystemExit(2) from None
        # on our own logger, not on the root: rospy replaces the root's handlers
        log = logging.getLogger("robot")
        log.setLevel(settings.log_level.upper())
        handler = logging.StreamHandler()
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s"))
        log.addHandler(handler)
        return settings

    @property
    def caller_id(self) -> str:
        """The ROS name under which this robot asks for its ID: the server tells robots apart by it."""
        return "/id_service_client_" + re.sub(r"[^A-Za-z0-9_]", "_", self.robot_name)

    @property
    def alive_url(self) -> str:
        return f"http://{self.master}:{self.web_port}/incAlive"


def _master_uri(uri: str) -> str:
    if not re.fullmatch(r"http://[^/:]+:[0-9]+/?", uri):
        raise ValueError(f"ROS_MASTER_URI={uri}: must be http://host:port")
    return uri


def _number(env: Mapping[str, str], name: str, default: float, bounds: tuple[float, float]) -> float:
    text = env.get(name) or str(default)
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not bounds[0] <= value <= bounds[1]:
        raise ValueError(f"{name}={text}: must be a number from {bounds[0]:g} to {bounds[1]:g}")
    return value


def _led(env: Mapping[str, str]) -> int | None:
    text = env.get("LASERBOT_LED") or "18"
    if text == "none":
        return None
    if not (text.isascii() and text.isdigit() and int(text) in HEADER_GPIOS):
        raise ValueError(f"LASERBOT_LED={text}: must be a GPIO from 0 to {HEADER_GPIOS[-1]}, or none")
    return int(text)


def default_robot_name(interfaces: Path = Path("/sys/class/net")) -> str:
    """Host name and MAC address: the same at each boot, different on each robot of a cloned SD card."""
    addresses = {path.parent: path.read_text().strip() for path in sorted(interfaces.glob("*/address"))}
    usable = [path for path, address in addresses.items() if address.strip("0:")]
    # hardware before bridges and tunnels, which come and go; inside a container there may be no hardware
    best = min(usable, key=lambda path: (not (path / "device").exists(), path.name), default=None)
    return "_".join([socket.gethostname(), *([addresses[best]] if best else [])])
