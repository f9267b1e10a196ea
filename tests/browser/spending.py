"""What a browser spends of the processor."""

import os
import re
import time
from collections import defaultdict
from collections.abc import Callable

import psutil

from tests.support.processes import command_line, descendants


def spending(act: Callable[[], object]) -> dict[str, float]:
    """% of a core that each type of Chromium's processes takes meanwhile: renderer, gpu-process, browser..."""
    before, start = _seconds(), time.monotonic()
    act()
    spent = time.monotonic() - start
    return {kind: 100 * (seconds - before[kind]) / spent for kind, seconds in _seconds().items()}


def _seconds() -> defaultdict[str, float]:
    """The processor's time by type, which command lines tell, of all browsers that this program has started."""
    seconds: defaultdict[str, float] = defaultdict(float)
    for process in descendants(os.getpid()):
        line = command_line(process)
        if not re.search(r"/chromium(-headless-shell)?( |$)", line):
            continue
        kind = re.search(r"--type=([\w-]+)", line)
        try:
            times = process.cpu_times()
        except psutil.NoSuchProcess:  # it has ended meanwhile
            continue
        seconds[kind[1] if kind else "browser"] += times.user + times.system
    return seconds
