"""What the program holds of its database: enough for another file, when somebody takes away the one that is open."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from server.game import events
from server.game.events import Recorded

MAX_EVENTS = 20_000  # of the battle that runs, which has some hundred

FileId = tuple[int, int]  # device and inode
UNSEEN: FileId = (0, 0)  # something may be there, but it cannot be looked at


def file_id(path: Path | None) -> FileId | None:
    """Which file is at `path`, None if there is none."""
    if path is None:
        return None
    try:
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError:
        return UNSEEN
    return found.st_dev, found.st_ino


@dataclass
class Held:
    """Out of what is written."""

    robots: dict[str, int] = field(default_factory=dict)  # IDs by ROS names, the newest last
    _battle: list[Recorded] = field(default_factory=list)  # from its start on; empty while none runs

    def keep(self, written: Iterable[Recorded]) -> None:
        for one in written:
            match one.event:
                case events.RobotLinked(robot, True, caller) if caller:
                    self.keep_robots({caller: robot})
                case events.BattleStarted():
                    self._battle = [one]
                case events.BattleEnded():
                    self._battle = []
                case _ if 0 < len(self._battle) < MAX_EVENTS:
                    self._battle.append(one)

    def keep_robots(self, ids: Mapping[str, int]) -> None:
        for caller, robot in ids.items():
            others = {other: its for other, its in self.robots.items() if other != caller and its != robot}
            self.robots = {**others, caller: robot}

    def take_battle(self) -> list[Recorded]:
        """The events of the battle that runs, which are held no longer."""
        taken, self._battle = self._battle, []
        return taken
