"""The bot's settings, from environment variables and arguments."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from laser_bot_battle.addresses import check_interface
from laser_bot_battle.names import BOT_PREFIX, ROBOT_IDS, is_bot
from laser_bot_battle.place import Place
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.variables import (
    ALIVE_FILE,
    ARENA,
    ARENA_NAME,
    BOT_LEVEL,
    INTERFACE,
    LOG_LEVEL,
    MASTER,
    ROS_MASTER_URI,
    ROSBRIDGE,
    WEB,
)

VARIABLES = (ARENA_NAME, MASTER, WEB, ROSBRIDGE, ROS_MASTER_URI, INTERFACE, ARENA, BOT_LEVEL, LOG_LEVEL, ALIVE_FILE)


@dataclass(frozen=True)
class Settings:
    """Who the bot is and where the others are."""

    name: str
    robot: int | None  # the ID of the robot to drive, None for any
    place: Place | None  # of the master; None if the bot is to find it
    arena: str  # the name of the one to join, "" for the only one
    rosbridge: str | None  # "host:port", if it is not where the master says
    view: str | None  # the arena's page, if it is not on the master's host
    rosbridge_port: int  # unless the master announces another
    view_port: int
    level: str  # how good it is
    log_level: str

    @classmethod
    def read(
        cls,
        env: Mapping[str, str],
        *,
        name: str = "Bot1",
        master: str | None = None,
        rosbridge: str | None = None,
        arena: str | None = None,
        robot: str | None = None,
    ) -> "Settings":
        """`rosbridge` and `arena` (its page) are "host:port", or the master's. SettingsError for a wrong value."""
        check_interface(env)
        if not is_bot(name):
            raise SettingsError(f"--name {name}: must be {BOT_PREFIX} and a number of up to 13 digits")
        if robot is not None and robot not in map(str, ROBOT_IDS):
            raise SettingsError(f"--robot {robot}: must be the ID of a robot, 0 to {max(ROBOT_IDS)}")
        rosbridge = _host_and_port("--rosbridge", rosbridge) if rosbridge else None
        if not master and not MASTER.read(env) and rosbridge:
            master = rosbridge.rpartition(":")[0]
        return cls(
            name=name,
            robot=None if robot is None else int(robot),
            place=Place.at(master, env, "as the command line says") if master else Place.given(env),
            arena=ARENA_NAME.read(env),
            rosbridge=rosbridge,
            view=_host_and_port("--arena", arena) if arena else None,
            rosbridge_port=ROSBRIDGE.read(env),
            view_port=ARENA.read(env),
            level=BOT_LEVEL.read(env),
            log_level=LOG_LEVEL.read(env),
        )

    def web_url(self, place: Place) -> str:
        return f"http://{place.host}:{place.web}"

    def rosbridge_url(self, place: Place) -> str:
        return f"ws://{self.rosbridge or f'{place.host}:{place.rosbridge or self.rosbridge_port}'}"

    def view_url(self, place: Place) -> str:
        return f"ws://{self.view or f'{place.host}:{self.view_port}'}/view"


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


def first_free(name: str, taken: Collection[str]) -> str:
    """The bot's name, or the next one that is not taken, by the server's rule without regard to case: Bot1 -> Bot2."""
    folded = {other.casefold() for other in taken}
    while name.casefold() in folded:
        name = f"{BOT_PREFIX}{int(name.removeprefix(BOT_PREFIX)) + 1}"
    return name
