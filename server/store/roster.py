"""Which named robot has which ID: fixed by the operator (LASERBOT_ROSTER), or kept over restarts in robots.json.

The file is one JSON object, `{"/id_service_client_<robot's name>": ID}` with IDs 0 to 127.
"""

import json
import logging
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from laser_bot_battle.names import ROBOT_IDS, robot_name

_log = logging.getLogger(__name__)


class Roster:
    """The file in `folder`, which is made when it is missing. What is `fixed` (IDs by ROS names) goes before it."""

    def __init__(self, folder: Path, fixed: Mapping[str, int] | None = None) -> None:
        self.path = folder / "robots.json"
        self._fixed = dict(fixed or {})
        self._warned_of: set[str] = set()

    def load(self) -> dict[str, int]:
        """The IDs by the robots' ROS names. A broken file is kept beside as robots.json.broken."""
        taken = set(self._fixed.values())
        return self._fixed | {
            name: robot_id
            for name, robot_id in self._load_file().items()
            if name not in self._fixed and robot_id not in taken
        }

    def _load_file(self) -> dict[str, int]:
        try:
            return _parse(self.path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return {}
        except OSError as error:
            _log.error("cannot read %s (%s): robots get new IDs", self.path, error)
            return {}
        except (ValueError, RecursionError) as error:
            broken = self.path.with_suffix(".json.broken")
            _log.error("%s is broken (%s): kept as %s, robots get new IDs", self.path, error, broken.name)
            try:
                self.path.replace(broken)
            except OSError as failure:
                _log.error("cannot rename it to %s: %s", broken, failure)
            return {}

    def save(self, ids: dict[str, int]) -> None:
        """Replace the file as a whole, so that a power cut leaves the old or the new one. A failure is logged."""
        temporary = ""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            descriptor, temporary = tempfile.mkstemp(dir=self.path.parent, prefix="robots.", suffix=".tmp")
            with os.fdopen(descriptor, "w", encoding="utf-8") as file:
                json.dump(ids, file, indent=2, sort_keys=True)
                file.write("\n")
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, self.path)
        except OSError as error:
            _log.error("cannot write %s (%s): robots may get other IDs after a restart", self.path, error)
            if temporary:
                Path(temporary).unlink(missing_ok=True)

    def warn_of_lookalike(self, caller: str) -> None:
        """Warn, once, of a robot that seems to be a fixed one under its default name: host name, `_`, MAC address."""
        if caller in self._fixed or caller in self._warned_of:
            return
        meant = max((name for name in self._fixed if caller.startswith(f"{name}_")), key=len, default=None)
        if meant:
            self._warned_of.add(caller)
            name, fixed = robot_name(caller), robot_name(meant)
            _log.warning(
                "robot %s is not the %s of LASERBOT_ROSTER; if it should be, set LASERBOT_ROBOT_NAME=%s on it",
                name,
                fixed,
                fixed,
            )


def _parse(text: str) -> dict[str, int]:
    content = json.loads(text)
    if not isinstance(content, dict):
        raise ValueError("not a JSON object")
    for name, robot_id in content.items():
        if type(robot_id) is not int or robot_id not in ROBOT_IDS:
            raise ValueError(f"{name!r} has the ID {robot_id!r}, not a whole number from 0 to 127")
    return content
