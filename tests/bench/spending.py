"""What a battle and a browser spend of the processor."""

import os
import re
import time
from collections import defaultdict
from collections.abc import Callable

import psutil

from tests.support.processes import command_line, descendants

BROWSER = "Chromium's "  # before the kind of a process: main, renderer, gpu-process, NetworkService...


def spending(act: Callable[[], object]) -> dict[str, float]:
    """% of a core that each of the programs takes meanwhile that this one has started, several of a kind together."""
    before, start = _seconds(), time.monotonic()
    act()
    spent = time.monotonic() - start
    return {program: 100 * (seconds - before[program]) / spent for program, seconds in _seconds().items()}


def _seconds() -> defaultdict[str, float]:
    """The processor's time (s) by program."""
    seconds: defaultdict[str, float] = defaultdict(float)
    for process in descendants(os.getpid()):
        name = _name(command_line(process))
        try:
            times = process.cpu_times()
        except psutil.NoSuchProcess:  # it has ended meanwhile
            continue
        seconds[name] += times.user + times.system
    return seconds


def _name(line: str) -> str:
    """Of a program, by its command line: a module of Python, or the file."""
    if re.search(r"/chromium(-headless-shell)?( |$)", line):
        kind = re.search(r"--utility-sub-type=\w+\.mojom\.(\w+)", line) or re.search(r"--type=([\w-]+)", line)
        return BROWSER + (kind[1] if kind else "main")
    module = re.search(r" -m ([\w.]+)", line)
    files = [word.rsplit("/", maxsplit=1)[-1] for word in line.split() if not word.startswith("-")]
    script = next((file for file in files if not file.startswith("python")), "")
    return module[1] if module else script
