"""How the parts of a battle are: their processes, threads, open files and memory."""

import contextlib
import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from statistics import linear_regression
from typing import NamedTuple

import psutil

from laser_bot_battle.master import Master
from tests.support.battle import Battle
from tests.support.processes import descendants

# Pools fill up and connections stay for a while: so much more than at the beginning is no leak.
MORE_THREADS = 4
MORE_FILES = 16
# Memory is flat when it grows by less, in a life that was watched for so long.
GROWTH = 0.2  # MiB a minute
WATCHED = 300.0  # s


class Counts(NamedTuple):
    """Of all processes of one part."""

    processes: int
    threads: int
    files: int


def parts(battle: Battle) -> dict[str, list[psutil.Process]]:
    """The processes by what they run."""
    found = defaultdict(list)
    for process in descendants(battle.program.process.pid):
        with contextlib.suppress(psutil.NoSuchProcess):
            words = process.cmdline()
            if words:
                found[_name(words)].append(process)
    return dict(found)


def _name(words: list[str]) -> str:
    if "-m" in words:
        return words[words.index("-m") + 1]
    is_script = Path(words[0]).name.startswith("python") and len(words) > 1
    return Path(words[1] if is_script else words[0]).name


def count(battle: Battle) -> dict[str, Counts]:
    counts = {}
    for name, processes in parts(battle).items():
        with contextlib.suppress(psutil.NoSuchProcess):
            threads, files = (sum(ask(each) for each in processes) for ask in (_threads, _files))
            counts[name] = Counts(len(processes), threads, files)
    return counts


def _threads(process: psutil.Process) -> int:
    return int(process.num_threads())


def _files(process: psutil.Process) -> int:
    return int(process.num_fds())


def leaks(before: Mapping[str, Counts], after: Mapping[str, Counts]) -> list[str]:
    """What is there after that was not before, or the other way round."""
    found = []
    for name in sorted(before.keys() | after.keys()):
        old, new = before.get(name, Counts(0, 0, 0)), after.get(name, Counts(0, 0, 0))
        if new.processes != old.processes:
            found.append(f"{name}: {old.processes} processes became {new.processes}")
        elif new.threads > old.threads + MORE_THREADS:
            found.append(f"{name}: {old.threads} threads became {new.threads}")
        elif new.files > old.files + MORE_FILES:
            found.append(f"{name}: {old.files} open files became {new.files}")
    return found


def graph(battle: Battle) -> set[str]:
    """Who publishes, subscribes and serves what, as the ROS master knows it."""
    master = Master(f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}", "/soak")
    kinds = zip(("publishes", "subscribes to", "serves"), master.call("getSystemState"), strict=True)
    return {f"{node} {verb} {name}" for verb, entries in kinds for name, nodes in entries for node in nodes}


class Memory:
    """The sizes of all processes, now and then."""

    def __init__(self, battle: Battle) -> None:
        self._battle = battle
        self._sizes: dict[int, list[tuple[float, float]]] = {}  # by process: minutes, MiB
        self._names: dict[int, str] = {}

    def forget(self) -> None:
        """What was before does not count: programs fill up when they begin."""
        self._sizes.clear()

    def look(self) -> float:
        """The size of all together, MiB."""
        total = 0.0
        for name, processes in parts(self._battle).items():
            for process in processes:
                with contextlib.suppress(psutil.NoSuchProcess):
                    size = process.memory_info().rss / 2**20
                    self._names[process.pid] = name
                    self._sizes.setdefault(process.pid, []).append((time.monotonic() / 60, size))
                    total += size
        return total

    def growth(self) -> dict[str, float]:
        """MiB a minute of each process that was watched for long enough; of each part, the one that grows most."""
        found: dict[str, float] = {}
        for pid, sizes in self._sizes.items():
            minutes, sizes_only = zip(*sizes, strict=True)
            if (minutes[-1] - minutes[0]) * 60 >= WATCHED:
                slope = linear_regression(minutes, sizes_only).slope
                found[self._names[pid]] = max(slope, found.get(self._names[pid], slope))
        return found
