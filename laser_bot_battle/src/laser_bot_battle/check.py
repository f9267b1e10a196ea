"""Says all that is wrong with settings before a program reads them, a line each.

    python3 -m laser_bot_battle.check                       those of the environment, and the file of its floor
    python3 -m laser_bot_battle.check .env                  those of a file that compose reads
    kubectl kustomize FOLDER | python3 -m laser_bot_battle.check -     those of Kubernetes' manifests

A file is read as manifests if it has a line that begins with apiVersion. "-" is the standard input. The exit code is
0 if nothing is wrong, 1 if something is, and 2 if the file cannot be read.
"""

import argparse
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any

from laser_bot_battle.floor import FloorError, floor_file, parse_floor, read_bytes
from laser_bot_battle.given_settings import Given, Group, of_file
from laser_bot_battle.operator_token import check_choice
from laser_bot_battle.settings import ROS_ADDRESSES, SettingsError, Variable, shown, unknown
from laser_bot_battle.variables import FLOOR, LASERBOT, OPERATOR_TOKEN, ROS_MASTER_URI

ALL: tuple[Variable[Any], ...] = (*LASERBOT, ROS_MASTER_URI, *ROS_ADDRESSES)
_NAMES = {variable.name for variable in ALL}
_MANIFEST = re.compile(r"""^[{\s"]*apiVersion\b""", re.MULTILINE)
# what only the kubelet or compose can fill in
_REFERENCE = re.compile(r"\$[({]")


def mistakes(group: Group) -> Iterator[str]:
    """What is wrong with the settings that a program would get together."""
    known = {name: given.value for name, given in group.items() if not _REFERENCE.search(given.value)}
    for name, text in unknown({name: given.value for name, given in group.items()}).items():
        yield group[name].where + text
    for variable in ALL:
        try:
            variable.read(known)
        except SettingsError as error:
            yield f"{group[variable.name].where}{error}"
    try:
        check_choice(known)
    except SettingsError as error:
        yield f"{group[OPERATOR_TOKEN.name].where}{error}"


def mistakes_in_floor(environ: Mapping[str, str]) -> Iterator[str]:
    """What is wrong with the file of the environment's floor. A wrong name is for `mistakes` to tell."""
    try:
        floor = FLOOR.read(environ)
    except SettingsError:
        return
    problems: Sequence[str] = ()
    try:
        parse_floor(read_bytes(floor_file(floor)))
    except OSError as error:
        problems = [f"cannot be read: {error.strerror}"]
    except FloorError as error:
        problems = error.problems
    except ValueError as error:
        problems = [str(error)]
    yield from (f"{FLOOR.name}={shown(floor)}: {problem}" for problem in problems)


def groups_of(text: str) -> tuple[list[Group], list[str]]:
    """The settings in a file, and what is wrong with the file itself. ValueError if it cannot be understood."""
    if _MANIFEST.search(text):
        try:
            reader = import_module("laser_bot_battle.manifest_settings")
        except ModuleNotFoundError:  # not every image or machine has what reads YAML
            raise ValueError("PyYAML is missing: apt-get install python3-yaml") from None
        groups: list[Group] = reader.groups(text)
        return groups, []
    group, wrong = of_file(text)
    return [group], wrong


def tell(groups: Iterable[Group], wrong: Iterable[str]) -> int:
    """Print what is wrong; returns the exit code."""
    groups = list(groups)
    lines = dict.fromkeys([*wrong, *(line for group in groups for line in mistakes(group))])
    settings = {(given.where, name) for group in groups for name, given in group.items() if name in _NAMES}
    for line in lines:
        print(line)
    summary = f"{len(lines)} to correct" if lines else f"nothing is wrong with {len(settings)} settings"
    print(f"laser_bot_battle.check: {summary}", file=sys.stderr)
    return 1 if lines else 0


def main() -> int:
    """The program; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="laser_bot_battle.check", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", nargs="?", help="of settings or manifests; - for the standard input")
    file = parser.parse_args().file
    if file is None:
        return tell([{name: Given(value) for name, value in os.environ.items()}], mistakes_in_floor(os.environ))
    try:
        if file == "-":
            text = sys.stdin.buffer.read().decode()
        else:
            with open(file, encoding="utf-8") as opened:
                text = opened.read()
        return tell(*groups_of(text))
    except (OSError, ValueError) as error:  # bytes that are no UTF-8 among them
        print(f"laser_bot_battle.check: {file} cannot be read: {' '.join(str(error).split())}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
