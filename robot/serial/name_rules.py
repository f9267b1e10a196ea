"""Names that a device may not use: it drives its own robot, and is not the master."""

import re
from collections.abc import Collection

import rosgraph.names

from laser_bot_battle.names import ADD_NEW_ROBOT, GAME_STATUS, POSITIONS, SHOTS

_ROBOTS_OWN = re.compile(r"(/Robot[0-9]+)(/.*)?")
_MASTERS = (ADD_NEW_ROBOT, GAME_STATUS, POSITIONS, SHOTS)


def refusal(name: str, node: str, remapped: Collection[str], speaks: bool) -> str:
    """Why the device of `node` ("/Robot0") may not use a topic or a service of that name; empty if it may.

    `remapped`: whole names that the operator has given a new name, and answers for. `speaks`: the device publishes
    the topic or offers the service.
    """
    if not name.strip("/") or not rosgraph.names.is_legal_name(name):
        return f"{name!r} is not a legal name in ROS"
    whole = rosgraph.names.resolve_name(name, node)
    if whole in remapped:
        return ""
    other = _ROBOTS_OWN.fullmatch(whole)
    if other and other[1] != node:
        return f"{name!r} is another robot's: this one is {node}"
    if speaks and whole in _MASTERS:
        return f"{name!r} is the master's"
    return ""
