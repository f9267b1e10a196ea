"""Settings as somebody has written them down, with the place where each is."""

import re
from collections.abc import Mapping
from typing import NamedTuple

_SETTING = re.compile(r"(?:export\s+)?(?P<name>(?:LASERBOT|ROS_)[^\s=:]*)\s*(?P<rest>.*)", re.IGNORECASE)
_QUOTED = re.compile(r"""(?P<quote>["'])(?P<value>.*?)(?<!\\)(?P=quote)\s*(?:#.*)?""")


class Given(NamedTuple):
    """A value, and where it stands, to be put before what is wrong with it."""

    value: str
    where: str = ""


Group = Mapping[str, Given]  # by name: what a program gets together


def of_file(text: str) -> tuple[dict[str, Given], list[str]]:
    """The settings in a file with NAME=value lines as compose reads it, and what is wrong with these lines. All other
    lines are passed over."""
    found: dict[str, Given] = {}
    wrong: list[str] = []
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
        match = _SETTING.fullmatch(line.strip())
        if not match:
            continue
        name, rest, where = match["name"], match["rest"], f"line {number}: "
        if not rest.startswith("="):
            wrong.append(f"{where}{name}: must be {name}=value")
            continue
        if name in found:
            wrong.append(f"{where}{name}: is set before, too, in {found[name].where.removesuffix(': ')}")
        try:
            found[name] = Given(_value(rest[1:].strip()), where)
        except ValueError as error:
            wrong.append(f"{where}{name}: {error}")
    return found, wrong


def _value(text: str) -> str:
    """Without quotes and a comment after it."""
    if not text.startswith(("'", '"')):
        return re.sub(r"(^|\s+)#.*", "", text)
    match = _QUOTED.fullmatch(text)
    if not match:
        raise ValueError("its quotes do not end, or something comes after them")
    return match["value"]
