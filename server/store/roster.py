"""Which named robot has which ID: fixed by the operator (LASERBOT_ROSTER), else as the database has kept it."""

import json
import logging
from collections.abc import Mapping
from pathlib import Path

from laser_bot_battle.names import ROBOT_IDS, robot_name

_log = logging.getLogger(__name__)


class Roster:
    """The IDs that are `fixed`, by ROS names."""

    def __init__(self, fixed: Mapping[str, int]) -> None:
        self._fixed = dict(fixed)
        self._warned_of: set[str] = set()

    def with_fixed(self, kept: Mapping[str, int]) -> dict[str, int]:
        """The IDs by ROS names: what is fixed goes before what was `kept`."""
        taken = set(self._fixed.values())
        return self._fixed | {
            name: robot_id for name, robot_id in kept.items() if name not in self._fixed and robot_id not in taken
        }

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


def take_over_file(folder: Path) -> dict[str, int]:
    """The IDs in robots.json, where versions before 1.1 kept them: one JSON object, `{"/name": ID}`.

    The file is then renamed: to robots.json.imported, or to robots.json.broken if it is.
    """
    path = folder / "robots.json"
    ids: dict[str, int] = {}
    kept = path.with_suffix(".json.imported")
    try:
        ids = _parse(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except OSError as error:
        _log.error("cannot read %s (%s): robots get new IDs", path, error)
        return {}
    except (ValueError, RecursionError) as error:
        kept = path.with_suffix(".json.broken")
        _log.error("%s is broken (%s): kept as %s, robots get new IDs", path, error, kept.name)
    try:
        path.replace(kept)
    except OSError as failure:
        _log.error("cannot rename %s to %s: %s", path, kept.name, failure)
    return ids


def _parse(text: str) -> dict[str, int]:
    content = json.loads(text)
    if not isinstance(content, dict):
        raise ValueError("not a JSON object")
    for name, robot_id in content.items():
        if type(robot_id) is not int or robot_id not in ROBOT_IDS:
            raise ValueError(f"{name!r} has the ID {robot_id!r}, not a whole number from 0 to 127")
    return content
