"""`python3 -m server.overhead tags`: writes the tags of robots and of the floor to print, and the plan of the floor."""

import argparse
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path

from laser_bot_battle.apriltag import AprilTagError
from laser_bot_battle.floor import read_floor
from laser_bot_battle.names import ROBOT_IDS
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.tags import floor_tags
from laser_bot_battle.variables import FLOOR
from server.overhead.sheets import floor_sheet, plan_sheet, robot_sheet


def main(command: str, arguments: Sequence[str]) -> int:
    """Exit code 0, 1 when a file cannot be written or a library is missing, 2 for impossible arguments."""
    parser = argparse.ArgumentParser(command, description=__doc__)
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FOLDER", help="where the sheets are written, as SVG"
    )
    parser.add_argument("--floor", metavar="NAME", help=f"the floor, or its file (default: {FLOOR.name}, or battle)")
    parser.add_argument(
        "--robots", type=_robots, default="8", metavar="IDS", help="8: those from 0 to 7 (the default); or 1-8"
    )
    given = parser.parse_args(arguments)
    try:
        floor = read_floor(given.floor or FLOOR.read(os.environ))
        tags = floor_tags(floor)
        sheets = {f"robot-{robot}.svg": robot_sheet(robot) for robot in given.robots}
        sheets |= {f"floor-{number}.svg": floor_sheet(number, pose) for number, pose in tags.items()}
        sheets["plan.svg"] = plan_sheet(floor, tags)
        given.out.mkdir(parents=True, exist_ok=True)
        for name, sheet in sheets.items():
            (given.out / name).write_text(sheet)
    except SettingsError as error:
        parser.error(str(error))
    except (OSError, AprilTagError) as error:
        print(f"{command}: {error}", file=sys.stderr)
        return 1
    print(f"{len(sheets)} sheets are in {given.out}: begin with plan.svg, and print all at 100 %")
    return 0


def _robots(text: str) -> range:
    match = re.fullmatch(r"(?:([0-9]{1,3})-)?([0-9]{1,3})", text)
    if match:
        first, last = (int(match[1]), int(match[2])) if match[1] else (0, int(match[2]) - 1)
        if first <= last and last in ROBOT_IDS:
            return range(first, last + 1)
    raise argparse.ArgumentTypeError(f"must be a number of robots, or IDs such as 1-8, up to {ROBOT_IDS[-1]}")
