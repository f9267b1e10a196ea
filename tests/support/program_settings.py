"""What each program reads from its environment and which ports it opens, asked of its own settings."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from laser_bot_battle.names import ROS_PORT, WATCHED
from laser_bot_battle.variables import BACKUPS, LOG_FORMAT, LOG_LEVEL
from robot.camera.settings import VARIABLES as CAMERA
from robot.camera.settings import CameraSettings
from robot.settings import Settings as RobotSettings
from server.announcer.settings import Settings as AnnouncerSettings
from server.bots.settings import Settings as BotSettings
from server.camera.settings import Settings as RelaySettings
from server.entrance.settings import Settings as EntranceSettings
from server.front.settings import FrontSettings
from server.overhead.settings import Settings as OverheadSettings
from server.program.program import ProgramSettings as MasterProgramSettings
from server.rosbridge.settings import Settings as RosbridgeSettings
from server.store.location import database_url
from server.web.settings import Settings as WebSettings
from sim.arena.settings import Settings as ArenaSettings
from sim.positions import read_settings as read_positions_settings


class Recorder(Mapping[str, str]):
    """An environment that remembers which variables were asked for."""

    def __init__(self, variables: Mapping[str, str]) -> None:
        self._variables = variables
        self.read: set[str] = set()

    def __getitem__(self, name: str) -> str:
        self.read.add(name)
        return self._variables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._variables)

    def __len__(self) -> int:
        return len(self._variables)


ROS = {"ROS_MASTER_URI", "ROS_IP"}  # rospy and rosmaster read these themselves
Reader = Callable[[Mapping[str, str]], Any]


def _ports(found: Any, watched: str) -> set[int]:
    """The program's own, and where it can be watched."""
    metrics = found.program.metrics
    return {found.program.port, *([metrics[1] + WATCHED.index(watched)] if metrics else [])}


READERS: dict[str, tuple[Reader, Callable[[Any], set[int]], set[str]]] = {
    "server.ros.master": (LOG_LEVEL.read, lambda _: {ROS_PORT}, ROS),
    "server.ros.rosout": (MasterProgramSettings.from_env, lambda _: set(), ROS),
    "server.main": (WebSettings.from_env, lambda found: _ports(found, "web"), ROS),
    "server.rosbridge": (RosbridgeSettings.from_env, lambda found: _ports(found, "rosbridge"), ROS),
    "server.camera": (RelaySettings.from_env, lambda found: _ports(found, "relay"), ROS),
    "server.overhead": (OverheadSettings.from_env, lambda found: _ports(found, "overhead") - {0}, ROS),
    "server.front": (FrontSettings.from_env, lambda found: {found.http_port, found.https_port}, set()),
    "server.entrance": (EntranceSettings.from_env, lambda found: {found.port}, set()),
    "server.announcer": (AnnouncerSettings.from_env, lambda _: set(), set()),
    "sim.positions": (read_positions_settings, lambda _: set(), ROS),
    "server.bots": (BotSettings.read, lambda _: set(), set()),
    "server.store": (lambda environ: (database_url(environ), BACKUPS.read(environ)), lambda _: set(), set()),
    "robot.id_service_client": (RobotSettings.from_env, lambda _: set(), ROS),
    "robot.camera": (
        CameraSettings.from_env,
        lambda found: {found.port},
        {variable.name for variable in CAMERA},
    ),
    "sim.arena": (ArenaSettings.from_env, lambda found: {found.view_port, found.link_port}, set()),
}


class ProgramSettings:
    """The settings of the program that `command` starts in `environment`. ValueError: it would refuse them."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        self.settings: Any
        if command[:2] != ["python3", "-m"]:  # avr_robot has options instead
            self.settings, self.variables, self.ports = None, set(), set()
            return
        reader, ports, others = READERS[command[2]]
        recorder = Recorder(environment)
        self.settings = reader(recorder)
        self.variables = recorder.read | others | {LOG_FORMAT.name}  # which `configure_logging` reads
        self.ports = ports(self.settings)
