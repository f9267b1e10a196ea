"""The demo's settings: the address and the ports of its parts. All other variables are for the parts themselves."""

import secrets
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laser_bot_battle import listening
from laser_bot_battle.addresses import check_interface
from laser_bot_battle.floor import NAMES, read_floor
from laser_bot_battle.operator_token import read_operator_token
from laser_bot_battle.settings import SettingsError, Variable
from laser_bot_battle.variables import (
    ARENA,
    ARENA_LINK,
    BIND,
    FLOOR,
    INTERFACE,
    LASERBOT,
    LIGHT,
    OPERATOR_TOKEN,
    OPERATOR_TOKEN_FILE,
    RELAY,
    ROS,
    ROSBRIDGE,
    WEB,
)

HOST = "127.0.0.1"  # where the parts meet
MAX_PORT = 65535
PORTS = {
    WEB: "the game",
    ROSBRIDGE: "rosbridge",
    RELAY: "the cameras' pictures",
    ROS: "the ROS master",
    ARENA: "the simulator's own page",
    ARENA_LINK: "the robots' link to the arena",
}
VARIABLES: tuple[Variable[Any], ...] = (BIND, INTERFACE, *PORTS, LIGHT, FLOOR, OPERATOR_TOKEN, OPERATOR_TOKEN_FILE)


@dataclass(frozen=True)
class Settings:
    """Where the parts listen: address, and port by its variable's name; who is an operator; what light robots use."""

    bind: str
    ports: Mapping[str, int]
    new_token: str = ""  # of the operators; "": the environment has one
    light: str = "coded"  # of the robots
    floor: str = "battle"  # its name, or the absolute path of its file: the parts start elsewhere

    @classmethod
    def from_env(cls, env: Mapping[str, str]) -> "Settings":
        """SettingsError for a value that the demo or one of its parts would refuse, or a port that is in use."""
        for variable in LASERBOT:
            variable.read(env)
        check_interface(env)
        read_operator_token(env)
        bind = BIND.read(env, default=HOST)
        if bind not in (HOST, "0.0.0.0"):
            raise SettingsError(f"{BIND.name}={bind}: choose {HOST} (this machine only) or 0.0.0.0 (the network too)")
        ports: dict[str, int] = {}
        for variable in PORTS:
            port = variable.read(env)
            for other, taken in ports.items():
                if port == taken:
                    raise SettingsError(f"{other} and {variable.name} are both {port}: choose two ports")
            ports[variable.name] = port
        for variable, what in PORTS.items():
            port = ports[variable.name]
            if trouble := _trouble(bind, port):
                free = _free_port(bind, port, {*ports.values()})
                raise SettingsError(
                    f"port {port} ({what}) cannot be used: {trouble}. Stop the program that uses it (perhaps another "
                    f"demo is running), or choose another port: {variable.name}={free} make demo"
                )
        has_token = OPERATOR_TOKEN.read(env) or OPERATOR_TOKEN_FILE.read(env)
        floor = FLOOR.read(env)
        read_floor(floor)
        return cls(
            bind,
            ports,
            "" if has_token else secrets.token_urlsafe(12),
            LIGHT.read(env, default="coded"),
            floor if floor.lower() in NAMES else str(Path(floor).resolve()),
        )


def _trouble(bind: str, port: int) -> str:
    """Why the port cannot be used; empty if it can."""
    try:
        listening.bind(bind, port).close()
    except OSError as error:
        return error.strerror or str(error)
    return ""


def _free_port(bind: str, port: int, others: Collection[int]) -> int:
    """The next one that nobody uses, nor the demo's other parts; failing that, whichever the system has."""
    for candidate in range(port + 1, min(port + 1000, MAX_PORT) + 1):
        if candidate not in others and not _trouble(bind, candidate):
            return candidate
    with listening.bind(bind, 0) as found:
        return int(found.getsockname()[1])
