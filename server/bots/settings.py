"""The settings of the bots' program, from environment variables and arguments."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from laser_bot_battle.addresses import check_interface
from laser_bot_battle.names import BOT_PREFIX
from laser_bot_battle.place import Place
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.variables import (
    ALIVE_FILE,
    ARENA_NAME,
    BIND,
    INTERFACE,
    LOG_FORMAT,
    LOG_LEVEL,
    MASTER,
    ROS_MASTER_URI,
    ROSBRIDGE,
    WEB,
)

VARIABLES = (ARENA_NAME, MASTER, WEB, ROSBRIDGE, ROS_MASTER_URI, INTERFACE, BIND, LOG_LEVEL, LOG_FORMAT, ALIVE_FILE)


@dataclass(frozen=True)
class Settings:
    """Where the others are."""

    place: Place | None  # of the master; None if it is to be found
    arena: str  # the name of the one to join, "" for the only one
    rosbridge: str | None  # "host:port", if it is not where the master says
    rosbridge_port: int  # unless the master announces another
    log_level: str

    @classmethod
    def read(cls, env: Mapping[str, str], *, master: str | None = None, rosbridge: str | None = None) -> "Settings":
        """`rosbridge` is "host:port", or the master's. SettingsError for a wrong value."""
        check_interface(env)
        rosbridge = _host_and_port("--rosbridge", rosbridge) if rosbridge else None
        if not master and not MASTER.read(env) and rosbridge:
            master = rosbridge.rpartition(":")[0]
        place = Place.at(master, env, "as the command line says") if master else Place.given(env)
        bind = BIND.read(env)
        if place and place.host == "localhost" and bind not in ("0.0.0.0", "::"):  # where this master listens
            place = replace(place, host=f"[{bind}]" if ":" in bind else bind)
        return cls(
            place=place,
            arena=ARENA_NAME.read(env),
            rosbridge=rosbridge,
            rosbridge_port=ROSBRIDGE.read(env),
            log_level=LOG_LEVEL.read(env),
        )

    def web_url(self, place: Place) -> str:
        return f"http://{place.host}:{place.web}"

    def rosbridge_url(self, place: Place) -> str:
        return f"ws://{self.rosbridge or f'{place.host}:{place.rosbridge or self.rosbridge_port}'}"


def _host_and_port(option: str, text: str) -> str:
    """`text` itself, which must be host:port."""
    host, _, port = text.rpartition(":")
    if not host:
        raise SettingsError(f"{option} {text}: must be HOST:PORT")
    try:
        WEB.parse(port)  # as every port
    except ValueError as error:
        raise SettingsError(f"{option} {text}: the port {error}") from None
    return text


def first_free(taken: Collection[str]) -> str:
    """The first bot's name that is not taken, by the server's rule without regard to case: Bot1, else Bot2 ..."""
    folded = {other.casefold() for other in taken}
    number = 1
    while f"{BOT_PREFIX}{number}".casefold() in folded:
        number += 1
    return f"{BOT_PREFIX}{number}"
